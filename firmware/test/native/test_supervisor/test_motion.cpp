// The motion of a follower: what cannot be true, what is not what its motor was told, and what honest arms do.
#include <doctest/doctest.h>
#include <supervisor.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

using namespace supervisor;

namespace {

constexpr Travel travel = {32, 25, 0};                     // 1 rad/(s V), 100 ms, stall_volts
constexpr MotionLimits limits = {25, 40, 32, 80, travel};  // 25 rad/s, 0.31 rad, 3.2 V, 20 s
constexpr double runaway_limit = 40 / 128.0, look_s = 0.004, gentle_from = 0.3, gentle_s = 0.064, try_again_s = 2.0;

using Course = std::function<double(double)>;  // of a time in s

// A reading that goes its own way, whatever the voltage.
struct Reading {
  // From begin to end, in s. The time of the fault, or -1.
  double run(double begin, double end, const Course& angle, const Course& volts, double error = 0) {
    for (double s = begin; s < end; s += look_s) {
      const auto follower = static_cast<std::int16_t>(std::lround(4096 * (angle(s) + noise(random))));
      const auto mv = static_cast<std::int16_t>(std::lround(1000 * volts(s)));
      const auto apart = static_cast<std::int16_t>(error == 0 ? (mv < 0 ? -400 : 400) : std::lround(4096 * error));
      fault = motion.look(2, {follower, apart, mv, 0}, chosen);
      if (held() && held_s < 0) held_s = s;
      if (fault != MotionFault::none) return s;
    }
    return -1;
  }
  bool held() const { return motion.hold(2) == Hold::back; }

  Motion motion;
  MotionLimits chosen = limits;
  MotionFault fault = MotionFault::none;
  double held_s = -1;  // when it was first held back
  std::mt19937 random{7};
  std::normal_distribution<double> noise{0, 0.0007};
};

Course always(double value) {
  return [value](double) { return value; };
}

}  // namespace

TEST_CASE("a reading that jumps is a fault at its next look, and one as fast as a joint is none") {
  for (const double jump : {0.12, -0.12, 1.0, -2.6, 5.2, -5.2}) {
    Reading joint;
    CHECK(
        joint.run(0, 2, [jump](double s) { return s < 1 ? 0 : jump; }, always(0)) == doctest::Approx(1).epsilon(0.005));
    CHECK(joint.fault == MotionFault::speed);
  }
  for (const double speed : {24.0, -24.0}) {
    CHECK(Reading().run(0, 0.2, [speed](double s) { return speed * s; }, always(speed < 0 ? -15 : 15)) < 0);
  }
  Reading unchecked;
  unchecked.chosen.speed = 0;
  CHECK(unchecked.run(0, 2, [](double s) { return s < 1 ? 0 : 2; }, always(0)) < 0);
}

TEST_CASE("after the motors' start the first look only learns where the joint is") {
  Reading joint;
  CHECK(joint.run(0, 1, always(1.0), always(0)) < 0);
  joint.motion.forget();
  CHECK(joint.run(1, 2, always(-1.5), always(0)) < 0);
}

TEST_CASE("a joint that its voltage drives backward is a fault once it has gone the limit") {
  for (const double volts : {4.0, 7.0, 15.0, -5.0, -15.0}) {
    for (const double share : {0.5, 1.0, 1.5}) {
      Reading joint;
      const double top = share * (std::abs(volts) - 2.4), sign = volts < 0 ? 1 : -1, tau = 0.05;
      const Course angle = [=](double s) { return sign * top * (s - tau * (1 - std::exp(-s / tau))); };
      const double end = joint.run(0, 4, angle, always(volts));
      CAPTURE(volts);
      CAPTURE(top);
      REQUIRE(end > 0);
      CHECK(joint.fault == MotionFault::runaway);
      CHECK(std::abs(angle(end)) > runaway_limit);
      const double hidden = top < 2 ? 0.25 : 0.1;  // by noise, and before it is as fast as the voltage would make it
      CHECK(std::abs(angle(end)) < runaway_limit + hidden + top * 0.012);
    }
  }
}

TEST_CASE("a hand that pushes a joint against its voltage is no fault") {
  for (const double speed : {0.1, 0.3}) {
    const auto way = [speed](double s) { return -std::min(0.5, speed * s); };
    const auto volts = [&](double s) { return std::min(15.0, 40 * -way(s)); };
    CAPTURE(speed);
    CHECK(Reading().run(0, 10, way, volts) < 0);
  }
}

TEST_CASE("a joint that its voltage brakes is proper, from any speed, and keeps its voltage") {
  for (const double speed : {1.0, 3.0, 6.0, 10.0}) {
    for (const double brake : {5.0, 20.0, 80.0}) {
      const Course angle = [=](double s) {
        const double t = std::min(s, speed / brake);
        return speed * t - brake * t * t / 2;
      };
      CAPTURE(speed);
      CAPTURE(brake);
      if (speed * speed / brake / 2 * 0.13 > 0.9 * runaway_limit)
        continue;  // a sixteenth of the speed is so long a way
      Reading joint;
      CHECK(joint.run(0, std::min(1.0, speed / brake), angle, always(-2.4 - 0.1 * brake)) < 0);
      CHECK_FALSE(joint.held());
    }
  }
}

TEST_CASE("a joint that is fast already when its voltage comes to be against it may go twice the way, not farther") {
  for (const double speed : {2.0, 8.0}) {
    Reading joint;
    const Course angle = [speed](double s) { return speed * s; };
    CHECK(joint.run(0, 1, angle, [](double s) { return s < 0.1 ? 6.0 : -6.0; }) ==
          doctest::Approx(0.1 + 2 * runaway_limit / speed).epsilon(0.1));
    CHECK(joint.fault == MotionFault::runaway);
  }
}

TEST_CASE("a spring that throws a joint to and fro against its voltage is no runaway") {
  const auto swing = [](double s) { return 0.35 * std::sin(55 * s); };
  Reading joint;
  CHECK(joint.run(0, 2, swing, [](double s) { return std::sin(55 * s + 0.7) > 0 ? -10.0 : 10.0; }) < 0);
}

TEST_CASE("a joint that vibrates against its voltage goes no way") {
  const auto swing = [](double s) { return 0.1 * std::sin(60 * s); };
  CHECK(Reading().run(0, 20, swing, [](double s) { return std::cos(60 * s) > 0 ? -6.0 : 6.0; }) < 0);
}

TEST_CASE("a joint that does not move is held back once its voltage should have moved it, and a fault after the time") {
  for (const double volts : {4.0, 7.0, -7.0, 15.0}) {
    Reading joint;
    const double end = joint.run(0, 30, always(0.5), always(volts));
    CAPTURE(volts);
    const double speed = std::abs(volts) - 2.4, late = std::min(0.12, 6 * look_s * speed);
    CHECK(joint.held_s == doctest::Approx((gentle_from + late) / speed + gentle_s).epsilon(0.1));
    CHECK(joint.fault == MotionFault::stalled);
    CHECK(end == doctest::Approx(20).epsilon(0.05));
  }
  Reading unchecked;
  unchecked.chosen.stall = 0;
  CHECK(unchecked.run(0, 30, always(0.5), always(15)) < 0);
  CHECK(unchecked.held_s < 0);
}

TEST_CASE("a joint that is held back is tried again, and let go when it moves or the reference comes back") {
  Reading joint;
  joint.run(0, 0.5, always(0.5), always(7));
  REQUIRE(joint.held());
  joint.run(0.5, 0.5 + 0.8 * try_again_s, always(0.5), always(0));
  CHECK(joint.held());
  joint.run(0.5 + 0.8 * try_again_s, 0.5 + 1.2 * try_again_s, always(0.5), always(0));
  CHECK_FALSE(joint.held());
  joint.run(4, 4.5, always(0.5), always(7));
  REQUIRE(joint.held());
  Reading moves = joint, back = joint;
  moves.run(4.5, 4.8, [](double s) { return 0.5 + 0.5 * (s - 4.5); }, always(4.8));
  CHECK_FALSE(moves.held());
  back.run(4.5, 4.51, always(0.5), always(0), -0.1);
  CHECK_FALSE(back.held());
}

TEST_CASE("what holds a load, moves slowly or starts late is not held back") {
  Reading holds, slow, late;
  holds.run(0, 60, always(0.5), always(2.9));
  slow.run(0, 10, [](double s) { return 0.4 * s - 2; }, always(5));
  late.run(0, 1, [](double s) { return s < 0.02 ? 0 : 6 * (s - 0.02); }, always(15));
  for (const Reading* joint : {&holds, &slow, &late}) CHECK(joint->held_s < 0);
}

TEST_CASE("a joint that goes up is told from one that stands or goes down") {
  for (const double speed : {0.6, 0.0, -0.6}) {
    Reading joint;
    joint.run(0, 0.3, [speed](double s) { return speed * s; }, always(2), 1);
    CHECK(joint.motion.goes(2, true) == (speed > 0));
    CHECK(joint.motion.goes(2, false) == (speed < 0));
  }
}

TEST_CASE(
    "a joint that gives way while it is pushed carries more than is known, and less once it rests or rises with less") {
  Reading sinks, stands;
  sinks.run(0, 0.5, always(0.5), always(7));
  stands.run(0, 0.5, always(0.5), always(7));
  REQUIRE(sinks.held());
  sinks.run(0.5, 0.8, [](double s) { return 0.5 - 0.2 * (s - 0.5); }, always(0), 0.1);
  CHECK(sinks.motion.load_mv(2) > 1500);
  stands.run(0.5, 1, always(0.5), always(0), 0.1);
  CHECK(stands.motion.load_mv(2) == 0);
  Reading rises = sinks;
  sinks.run(0.8, 5, always(0.44), always(-4), -0.01);
  CHECK(sinks.motion.load_mv(2) == 0);
  rises.run(0.8, 1.3, [](double s) { return 0.44 + 0.5 * (s - 0.8); }, always(-4), -0.01);
  CHECK(rises.motion.load_mv(2) == 0);
}

TEST_CASE("a reading that freezes as its joint turns back, and one with single wrong values, show no load") {
  Reading turns;
  turns.run(0, 0.3, [](double s) { return -2 * s; }, always(-3.5), 0.2);
  turns.run(0.3, 2, always(-0.6), always(14), 1);
  REQUIRE(turns.held_s > 0);
  CHECK(turns.motion.load_mv(2) == 0);
  // Single readings beyond the play, to both sides in turn.
  const auto spikes = [](double s) {
    const auto look = std::lround(s / look_s);
    return 0.5 + (look % 20 != 0 ? 0 : look % 40 == 0 ? 0.012 : -0.012);
  };
  Reading noisy;
  noisy.noise = std::normal_distribution<double>(0, 1e-9);
  noisy.run(0, 5, spikes, always(7), 1);
  REQUIRE(noisy.held());
  CHECK(noisy.motion.load_mv(2) == 0);
}

TEST_CASE("an elbow that its shoulder throws back is not held back for that, but beside any other joint it is") {
  const auto speeds_up = [](double speed, double s, double tau) {
    return speed * (s - tau * (1 - std::exp(-s / tau)));
  };
  for (const int quick : {1, 0, 3}) {
    Motion motion;
    bool pushed_gently = false;
    for (double s = 0; s < 0.5; s += look_s) {
      for (std::uint8_t joint = 0; joint < 4; ++joint) {
        const double angle = joint == 2       ? speeds_up(12, std::max(0.0, s - 0.05), 0.1)
                             : joint == quick ? speeds_up(10, s, 0.03)
                                              : 0;
        const auto volts_mv = static_cast<std::int16_t>(joint == 2 ? 15000 : joint == quick ? 12000 : 0);
        const auto follower = static_cast<std::int16_t>(std::lround(4096 * angle));
        CHECK(motion.look(joint, {follower, 400, volts_mv, 0}, limits) == MotionFault::none);
      }
      pushed_gently = pushed_gently || motion.hold(2) != Hold::free;
    }
    CAPTURE(quick);
    CHECK(pushed_gently == (quick != 1));
  }
}
