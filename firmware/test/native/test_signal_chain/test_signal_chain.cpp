// The tick's arithmetic around the control law against its definitions, in wider integers.
#include <doctest/doctest.h>
#include <signal_chain/duty.h>
#include <signal_chain/pot.h>
#include <signal_chain/soft_start.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>

using namespace signal_chain;

namespace {

std::int64_t floor_divide(std::int64_t a, std::int64_t b) { return a / b - (a % b != 0 && (a < 0) != (b < 0)); }

constexpr int full_duty[] = {400, 255};

}  // namespace

TEST_CASE("the upper product is the product's upper half, for every first factor") {
  int wrong = 0;
  for (const std::uint32_t b : {0u, 1u, 2u, 255u, 256u, 32768u, 34953u, 65280u, 65535u}) {
    for (std::uint32_t a = 0; a < 65536; ++a) {
      const auto half = upper_product(static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b));
      wrong += half != std::uint64_t{a} * b / 65536;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a tick of the low-pass is the rounded mean of what it keeps and what it takes") {
  int wrong = 0;
  for (std::uint8_t shift = 0; shift <= 4; ++shift) {
    const int parts = 1 << shift;
    for (int sum = 0; sum <= 4092; sum += 11) {
      for (int old = 0; old <= 65472; old += 97) {
        const auto next = filter(static_cast<std::uint16_t>(old), static_cast<std::uint16_t>(sum), low_pass(shift));
        // old - old / parts + sum * 16 / parts; a half of what is kept rounds up
        const std::int64_t kept = floor_divide(std::int64_t{old} * (parts - 1) * 2 + parts, 2 * parts);
        wrong += next != kept + sum * 16 / parts;
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("an angle is ((count14 - zero) * scale + 4096) >> 13, with count14 not rounded") {
  std::mt19937 random(14);
  int wrong = 0;
  const auto check = [&](int filtered, int zero, int scale) {
    const Pot pot = {static_cast<std::uint16_t>(filtered), static_cast<std::int16_t>(scale),
                     offset(static_cast<std::uint16_t>(zero), static_cast<std::int16_t>(scale))};
    const std::int64_t angle_q12 = floor_divide((std::int64_t{filtered} - 4 * zero) * scale + 4 * 4096, 4 * 8192);
    wrong += angle(pot) != angle_q12;
  };
  for (const int scale : {10734, -10734, 1, -1, 16384, -16384}) {
    for (const int zero : {0, 1, 8184, 16368}) {
      for (int filtered = 0; filtered <= 65472; ++filtered) check(filtered, zero, scale);
    }
  }
  for (int i = 0; i < 1000000; ++i) {
    check(static_cast<int>(random() % 65473), static_cast<int>(random() % 16369),
          static_cast<int>(random() % 32769) - 16384);
  }
  CHECK(wrong == 0);
}

TEST_CASE("clamp and distance are what they say at the ends of their numbers") {
  constexpr std::int16_t values[] = {-32768, -32767, -5, -1, 0, 1, 5, 32767};
  for (const std::int16_t a : values) {
    CHECK(clamp(a, -5, 5) == std::min(std::max(int{a}, -5), 5));
    for (const std::int16_t b : values) CHECK(distance(a, b) == std::abs(int{a} - int{b}));
  }
}

TEST_CASE("a soft start rises by equal steps and is full with its last tick, not before") {
  constexpr std::uint16_t durations[] = {1, 2, 3, 100, 1000, 7777, 10000, 65535};
  for (const std::uint16_t ticks : durations) {
    CAPTURE(ticks);
    SoftStart start;
    CHECK(start.share_q15() == 0);
    start.start(ticks);
    CHECK(start.share_q15() == 0);
    double worst = 0;
    int early = 0;
    for (unsigned tick = 1; tick < ticks; ++tick) {
      early += start.advance();
      worst = std::max(worst, std::abs(start.share_q15() - 32768.0 * tick / ticks));
    }
    CHECK(early == 0);
    CHECK(worst <= 2);  // q15: a step loses up to 2^-31 of the supply a tick
    CHECK(start.advance());
    CHECK(start.share_q15() == 32768);
    start.stop();
    CHECK(start.share_q15() == 0);
  }
}

TEST_CASE("the limit is the share of the supply, rounded down") {
  int wrong = 0;
  for (const int supply : {3000, 12345, 30000}) {
    for (int share = 0; share <= 32768; ++share) {
      wrong +=
          limit_mv(static_cast<std::uint16_t>(supply), static_cast<std::uint16_t>(share)) != supply * share / 32768;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a duty is the step nearest to its voltage, 0 at none and full at the supply") {
  for (const int full : full_duty) {
    for (int supply = 3000; supply <= 30000; supply += 271) {
      const std::uint16_t scale = duty_scale(static_cast<std::uint16_t>(full), static_cast<std::uint16_t>(supply));
      double worst = 0;
      for (int mv = 0; mv <= supply; ++mv) {
        worst = std::max(
            worst, std::abs(duty(static_cast<std::uint16_t>(mv), scale) - static_cast<double>(mv) * full / supply));
      }
      CHECK(worst < 0.56);  // half a step, and what the rounded scale costs at a high supply
      CHECK(duty(0, scale) == 0);
      CHECK(duty(static_cast<std::uint16_t>(supply), scale) == full);
    }
  }
}
