// What counts as a jump of a leader's reading: no hand is that fast at once.
#include <doctest/doctest.h>
#include <jumps.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

using supervisor::Jumps;

namespace {

constexpr std::uint8_t limit = 25;  // rad/s
constexpr double look_s = 0.004;

using Course = std::function<double(double)>;  // rad, of a time in s

// A course at even speed from 0.1 s on.
Course glide(double way, double takes_s) {
  return [=](double s) { return way * (takes_s > 0 ? std::min(1.0, std::max(0.0, (s - 0.1) / takes_s)) : s >= 0.1); };
}

// The same as a hand moves: at rest at both ends, without a jerk.
Course throws(double way, double takes_s) {
  return [=](double s) {
    const double t = std::min(1.0, std::max(0.0, (s - 0.1) / takes_s));
    return way * t * t * t * (10 + t * (6 * t - 15));
  };
}

// Whether that is a jump, whichever part of a look has passed as it begins.
bool always_jumps(const Course& angle, std::uint8_t most = limit, bool expected = true) {
  for (int phase = 0; phase < 4; ++phase) {
    Jumps jumps;
    bool jumped = false;
    double reading = angle(0);
    int tick = 0;
    for (double s = 0; s < 0.5; s += look_s / 4) {
      reading += (angle(s) - reading) / 2;  // the low-pass of a reading
      if (++tick % 4 == phase) jumped |= jumps.look(2, static_cast<std::int16_t>(std::lround(4096 * reading)), most);
    }
    if (jumped != expected) return !expected;
  }
  return expected;
}

bool never_jumps(const Course& angle, std::uint8_t most = limit) { return !always_jumps(angle, most, false); }

}  // namespace

TEST_CASE("a reading that leaves at more than the limit at once has jumped, up or down, by little or all the way") {
  for (const double sign : {1.0, -1.0}) {
    for (const double way : {0.22, 0.3, 1.0, 2.0, 5.0}) CHECK(always_jumps(glide(sign * way, 0)));
    CHECK(always_jumps(glide(sign * 0.3, 0.005)));
    CHECK(always_jumps(glide(sign * 1.0, 0.005)));
    CHECK(always_jumps(glide(sign * 1.0, 0.020)));
    CHECK(always_jumps(glide(sign * 2.0, 0.020)));
    CHECK(always_jumps(throws(sign * 2.0, 0.020)));
  }
}

TEST_CASE("a reading that jumps to and fro has jumped, however soon it comes back") {
  for (const double away_s : {0.003, 0.010, 0.050, 0.200}) {
    CHECK(always_jumps([=](double s) { return s < 0.1 || std::fmod(s - 0.1, 2 * away_s) >= away_s ? 0.0 : 1.0; }));
  }
}

TEST_CASE("a leader that is thrown has not jumped, and nor has one that hits something or falls") {
  for (const double way : {0.5, 1.0, 1.5, -1.5}) CHECK(never_jumps(throws(way, 0.040)));
  CHECK(never_jumps([](double s) { return throws(1.5, 0.060)(std::min(s, 0.130)); }));  // stops at 47 rad/s
  CHECK(never_jumps([](double s) { return std::min(1.5, 0.5 * 150 * s * s); }));        // falls, 21 rad/s at the end
  CHECK(never_jumps([](double s) { return std::abs(std::sin(20 * s)); }));              // bounces at 20 rad/s
}

TEST_CASE("noise, a dirty track and a tremor have not jumped") {
  std::uint32_t random = 1;
  const auto noise = [&random] {
    random = random * 1664525u + 1013904223u;
    return static_cast<double>(random >> 16) / 65536 - 0.5;
  };
  CHECK(never_jumps([&](double) { return 0.03 * noise(); }));  // six counts to either side
  CHECK(never_jumps([](double s) { return std::fmod(s, 0.05) < 0.002 ? 0.09 : 0.0; }));
  CHECK(never_jumps([](double s) { return 0.02 * std::sin(75 * s); }));
}

TEST_CASE("each joint is looked at by itself, and without a limit nothing has jumped") {
  Jumps jumps;
  for (std::uint8_t joint = 0; joint < 4; ++joint) {
    jumps.look(joint, static_cast<std::int16_t>(4000 * joint), limit);
    jumps.look(joint, static_cast<std::int16_t>(4000 * joint), limit);
  }
  for (std::uint8_t joint = 0; joint < 4; ++joint)
    CHECK_FALSE(jumps.look(joint, static_cast<std::int16_t>(4000 * joint + 10), limit));
  CHECK(jumps.look(1, 0, limit));
  CHECK(jumps.look(3, 0, limit));
  CHECK(never_jumps(glide(2.0, 0), 0));
}
