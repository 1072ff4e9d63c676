// What a joint's motor may get: all while the joint moves, and what holds it against gravity when it is held back.
#include <doctest/doctest.h>
#include <joint_guard.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>

using namespace supervisor;

namespace {

constexpr double look_s = 0.004;
constexpr MotionLimits limits = {25, 40, 32, 80, {32, 25, 12}};  // breakaway 1.2 V
constexpr std::uint8_t pitch[] = {1, 2}, not_pitch[] = {0, 3};   // joints
constexpr double bends[] = {-0.8, 0, 0.6};                       // rad
constexpr double gentle_v = 1.5 * 1.2;                           // a gentle push where nothing hangs on the joint
constexpr double slow_v = 0.032, quick_v = 0.512;                // that come back with a look
constexpr double first_v = 2.0, second_v = 1.5, elbow_v = 1.0;   // of level links

// An arm at these pitches that stands still, whatever its motors get.
struct Stuck {
  Stuck(double pitch_1, double pitch_2)
      : gravity{
            static_cast<std::int16_t>(std::lround(4096 * pitch_1)),
            static_cast<std::int16_t>(std::lround(4096 * pitch_2)), static_cast<std::int8_t>(std::lround(10 * first_v)),
            static_cast<std::int8_t>(std::lround(10 * second_v)), static_cast<std::int8_t>(std::lround(10 * elbow_v))} {
    supervisor.set_limits({3277, 0, 1, 100});
    supervisor.begin(false, true);
    for (int i = 0; i < 20; ++i) supervisor.tick({});
    for (std::uint8_t joint = 0; joint < joint_count; ++joint) look(joint, 1, 0, 0);  // as long as the motors are off
    REQUIRE(supervisor.enable(0, {}, {}).refusal == NackCode::none);
  }

  // So many looks at a joint whose motor gets the voltage, its reference a long way off, and that somebody moves at a
  // speed in rad/s. What it may get then, in V.
  double look(std::uint8_t joint, unsigned looks, double volts, double error, double speed = 0) {
    const auto apart = static_cast<std::int16_t>(std::lround(4096 * error));
    const auto mv = static_cast<std::int16_t>(std::lround(1000 * volts));
    for (; looks > 0; --looks) {
      place = static_cast<std::int16_t>(place + std::lround(4096 * look_s * speed));
      guard.look(supervisor, joint, {place, apart, mv, 0}, limits, gravity);
    }
    REQUIRE(supervisor.fault() == Fault::none);
    return guard.most_mv(joint) == UINT16_MAX ? INFINITY : guard.most_mv(joint) / 1000.0;
  }

  Supervisor supervisor;
  JointGuard guard;
  std::int16_t place = 0;  // of the joint looked at, q12 rad
  Gravity gravity;
};

}  // namespace

TEST_CASE("a joint may get all until its motor has been told to move it and it has not moved") {
  Stuck arm(0, 0);
  CHECK(std::isinf(arm.look(0, 500, 0.5, 1)));
  CHECK(std::isinf(arm.look(3, 2, 12, 1)));
}

TEST_CASE("a stuck joint is pushed with half as much again as starts it, then gets less than friction holds") {
  for (const std::uint8_t joint : not_pitch) {
    Stuck arm(0, 0);
    double may = INFINITY;
    while (std::isinf(may)) may = arm.look(joint, 1, 8, 1);
    CHECK(may == doctest::Approx(gentle_v));
    CHECK(arm.look(joint, 40, 8, 1) == 0);
  }
}

TEST_CASE("a joint that is held for a moment gets all back at once, unless that comes again and again") {
  Stuck arm(0, 0);
  const auto hold_and_free = [&arm] {
    while (std::isinf(arm.look(0, 1, 8, 1))) {
    }
    arm.look(0, 9, 8, 1);
    return arm.look(0, 1, 1, -1);
  };
  CHECK(std::isinf(hold_and_free()));
  arm.look(0, 200, 0, -1);
  CHECK(std::isinf(hold_and_free()));
  CHECK(std::isinf(hold_and_free()));
  CHECK(hold_and_free() < 2);
}

TEST_CASE("a joint that is let go gets all back step by step from a gentle push on, after a stop, too") {
  Stuck arm(0, 0);
  REQUIRE(arm.look(0, 400, 8, 1) == 0);
  CHECK(arm.look(0, 25, 2, -1) == doctest::Approx(gentle_v + 24 * slow_v));  // the reference has come back
  CHECK(std::isinf(arm.look(0, 500, 0, -1)));
  REQUIRE(arm.look(0, 400, 8, 1) == 0);
  arm.supervisor.stop();
  REQUIRE(arm.supervisor.enable(0, {}, {}).refusal == NackCode::none);
  CHECK(arm.look(0, 25, 2, -1) == doctest::Approx(gentle_v + 24 * slow_v));
}

TEST_CASE("a joint that is let go gets all back quickly when its controller asks for little") {
  Stuck arm(0, 0);
  REQUIRE(arm.look(0, 400, 8, 1) == 0);
  CHECK(arm.look(0, 25, 0, -1) == doctest::Approx(gentle_v + 24 * quick_v));
}

TEST_CASE("a joint that is let go and comes back fast gets less, down to a gentle push, until it is slower") {
  Stuck arm(0, 0);
  REQUIRE(arm.look(0, 400, 8, 1) == 0);
  REQUIRE(arm.look(0, 20, 0, -1) > 9);
  CHECK(arm.look(0, 60, 9, 1, 2) == doctest::Approx(gentle_v));
  CHECK(arm.look(0, 60, 9, 1, 0.5) > gentle_v + 40 * slow_v);
}

TEST_CASE("a joint that is let go may brake, on its way to its reference and, where it may fall, away from it") {
  for (std::uint8_t joint = 0; joint < joint_count; ++joint) {
    const bool falls = joint == pitch[0] || joint == pitch[1];
    for (const bool comes : {false, true}) {
      Stuck arm(0, 0);
      REQUIRE(arm.look(joint, 400, 8, 1) < 4);
      const double may = arm.look(joint, 12, -6, comes ? 1 : -1, 2);
      CHECK((may > 12 * slow_v + 4) == (comes || falls));
    }
  }
}

TEST_CASE("a joint that is held back gets what gravity takes at its pitch, up, and nothing down") {
  for (const double pitch_1 : bends)
    for (const double pitch_2 : bends) {
      const double both = std::cos(pitch_1 + pitch_2);
      const double held_v[] = {0, first_v * std::cos(pitch_1) + second_v * both, elbow_v * both, 0};
      for (const std::uint8_t joint : pitch) {
        Stuck arm(pitch_1, pitch_2);
        const double wanted = held_v[joint] - 1.2 / 2;
        CHECK(arm.look(joint, 400, 10, 1) == doctest::Approx(wanted < 0 ? 0 : wanted).epsilon(0.05).scale(1));
        CHECK(arm.look(joint, 400, -10, -1) == 0);
      }
    }
}
