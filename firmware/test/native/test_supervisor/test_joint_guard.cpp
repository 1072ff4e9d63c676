// What a joint's motor may get: all while the joint moves, and what holds it against gravity when it is held back.
#include <doctest/doctest.h>
#include <joint_guard.h>

#include <cmath>
#include <cstdint>

using namespace supervisor;

namespace {

constexpr double pi = 3.14159265358979;
constexpr MotionLimits limits = {25, 40, 32, 80, {32, 25, 12}};  // breakaway 1.2 V
constexpr std::uint8_t pitch[] = {1, 2}, not_pitch[] = {0, 3};   // joints
constexpr double bends[] = {-0.8, 0, 0.6};                       // rad
constexpr double first_v = 2.0, second_v = 1.5, elbow_v = 1.0;   // of level links

// An arm that stands still at these pitches, whatever its motors get.
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

  // So many looks at a joint whose motor gets the voltage, its reference a long way off. What it may get then, in V.
  double look(std::uint8_t joint, unsigned looks, double volts, double error) {
    const JointSeen seen = {0, static_cast<std::int16_t>(std::lround(4096 * error)),
                            static_cast<std::int16_t>(std::lround(1000 * volts)), 0};
    for (; looks > 0; --looks) guard.look(supervisor, joint, seen, limits, gravity);
    REQUIRE(supervisor.fault() == Fault::none);
    return guard.most_mv(joint) == UINT16_MAX ? INFINITY : guard.most_mv(joint) / 1000.0;
  }

  Supervisor supervisor;
  JointGuard guard;
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
    CHECK(may == doctest::Approx(1.5 * 1.2));
    CHECK(arm.look(joint, 40, 8, 1) == 0);
  }
}

TEST_CASE("a joint that is held for a moment gets all back at once, unless that comes again and again") {
  Stuck arm(0, 0);
  const auto hold_and_free = [&arm] {
    while (std::isinf(arm.look(0, 1, 8, 1))) {
    }
    arm.look(0, 9, 8, 1);
    return arm.look(0, 1, 0, -1);
  };
  CHECK(std::isinf(hold_and_free()));
  arm.look(0, 200, 0, -1);
  CHECK(std::isinf(hold_and_free()));
  CHECK(std::isinf(hold_and_free()));
  CHECK(hold_and_free() < 2);
}

TEST_CASE("a joint that is let go gets all back step by step, after a stop, too") {
  Stuck arm(0, 0);
  REQUIRE(arm.look(0, 400, 8, 1) == 0);
  CHECK(arm.look(0, 25, 0, -1) == doctest::Approx(25 * 0.064));  // the reference has come back
  CHECK(std::isinf(arm.look(0, 500, 0, -1)));
  REQUIRE(arm.look(0, 400, 8, 1) == 0);
  arm.supervisor.stop();
  REQUIRE(arm.supervisor.enable(0, {}, {}).refusal == NackCode::none);
  CHECK(arm.look(0, 25, 0, -1) == doctest::Approx(25 * 0.064));
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
