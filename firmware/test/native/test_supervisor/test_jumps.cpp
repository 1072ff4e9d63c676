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
    std::uint16_t tick = 65000;
    for (double s = 0; s < 0.5; s += look_s / 4) {
      reading += (angle(s) - reading) / 2;  // the low-pass of a reading
      const bool turn = ++tick % 4 == phase;
      jumped |= jumps.look(tick, turn ? static_cast<std::int16_t>(std::lround(4096 * reading)) : 0, most);
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
  jumps.forget();
  auto look = [&jumps, tick = std::uint16_t{0}](int reading) mutable {
    return jumps.look(++tick, static_cast<std::int16_t>(reading), limit);
  };
  for (const int wait : {0, 0, 10}) {
    for (const int joint : {1, 2, 3, 0}) CHECK_FALSE(look(4000 * joint + wait));
  }
  CHECK(look(0));           // joint 1
  CHECK_FALSE(look(8010));  // joint 2
  CHECK(look(0));           // joint 3
  CHECK(never_jumps(glide(2.0, 0), 0));
}

namespace {

// Looks at a course in a tick of 1 ms each, but in those that the link leaves no time for.
bool jumps_beside_the_link(const Course& angle, const std::function<bool(std::uint16_t)>& busy) {
  Jumps jumps;
  jumps.forget();
  bool jumped = false;
  std::uint16_t tick = 65400;  // it turns over on the way
  for (int ms = 0; ms < 1000; ++ms) {
    if (busy(++tick)) continue;
    jumped |= jumps.look(tick, static_cast<std::int16_t>(std::lround(4096 * angle(ms * 0.001))), limit);
  }
  return jumped;
}

}  // namespace

TEST_CASE("a hand has not jumped where the link took the time of a look, of many, or of every one at a joint") {
  const Course hand = [](double s) { return 0.8 * std::sin(5 * s); };  // 4 rad/s
  for (int turn = 0; turn < 4; ++turn) {
    for (const int every : {4, 8, 12, 20, 100})
      CHECK_FALSE(jumps_beside_the_link(hand, [=](std::uint16_t tick) { return tick % every == turn; }));
    for (const int until : {65500, 65534})
      CHECK_FALSE(jumps_beside_the_link(hand, [=](std::uint16_t tick) { return tick % 4 == turn && tick < until; }));
    CHECK_FALSE(jumps_beside_the_link(hand, [=](std::uint16_t tick) { return tick % 4 == turn && tick < 250; }));
  }
}

TEST_CASE("a jump is found beside the link, where that has taken the time of one look") {
  for (int turn = 0; turn < 4; ++turn) {
    for (const double way : {0.3, -1.0, 2.0})
      CHECK(jumps_beside_the_link(glide(way, 0), [=](std::uint16_t tick) { return tick % 8 == turn; }));
  }
}
