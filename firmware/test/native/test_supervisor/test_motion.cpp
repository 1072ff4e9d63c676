// The motion of a follower: what cannot be true or is not what its motor was told, and what is proper.
#include <doctest/doctest.h>
#include <supervisor.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

using namespace supervisor;

namespace {

constexpr MotionLimits limits = {25, 40, 32, 42};  // 25 rad/s, 0.31 rad, 3.2 V, 168 ms
constexpr double runaway_limit = 40 / 128.0;

using Course = std::function<double(double)>;  // of a time in s

struct Joint {
  // From begin to end, in s. The time of the fault, or -1.
  double run(double begin, double end, const Course& angle, const Course& volts) {
    for (double s = begin; s < end; s += 0.004) {
      const auto follower = static_cast<std::int16_t>(std::lround(4096 * (angle(s) + noise(random))));
      const auto mv = static_cast<std::int16_t>(std::lround(1000 * volts(s)));
      fault = motion.look(2, follower, mv, 15000, chosen);
      if (fault != MotionFault::none) return s;
    }
    return -1;
  }

  Motion motion;
  MotionLimits chosen = limits;
  MotionFault fault = MotionFault::none;
  std::mt19937 random{7};
  std::normal_distribution<double> noise{0, 0.0007};
};

Course always(double value) {
  return [value](double) { return value; };
}

}  // namespace

TEST_CASE("a reading that jumps is a fault at its next look, and one as fast as a joint is none") {
  for (const double jump : {0.12, -0.12, 1.0, -2.6, 5.2, -5.2}) {
    Joint joint;
    CHECK(
        joint.run(0, 2, [jump](double s) { return s < 1 ? 0 : jump; }, always(0)) == doctest::Approx(1).epsilon(0.005));
    CHECK(joint.fault == MotionFault::speed);
  }
  for (const double speed : {24.0, -24.0}) {
    CHECK(Joint().run(0, 0.2, [speed](double s) { return speed * s; }, always(speed < 0 ? -15 : 15)) < 0);
  }
  Joint unchecked;
  unchecked.chosen.speed = 0;
  CHECK(unchecked.run(0, 2, [](double s) { return s < 1 ? 0 : 2; }, always(0)) < 0);
}

TEST_CASE("after the motors' start the first look only learns where the joint is") {
  Joint joint;
  CHECK(joint.run(0, 1, always(1.0), always(0)) < 0);
  joint.motion.forget();
  CHECK(joint.run(1, 2, always(-1.5), always(0)) < 0);
}

TEST_CASE("a joint that runs against its voltage is a fault once it has gone the limit, and a look more") {
  for (const double volts : {2.5, 7.0, 15.0, -4.0, -15.0}) {
    for (const double top : {1.0, 5.0, 15.0}) {
      Joint joint;
      const double sign = volts < 0 ? 1 : -1, tau = 0.05;
      const Course angle = [=](double s) { return sign * top * (s - tau * (1 - std::exp(-s / tau))); };
      const double end = joint.run(0, 2, angle, always(volts));
      CAPTURE(volts);
      CAPTURE(top);
      REQUIRE(end > 0);
      CHECK(joint.fault == MotionFault::runaway);
      CHECK(std::abs(angle(end)) > runaway_limit);
      const double hidden = top < 2 ? 0.25 : 0.05;  // by noise, while the joint is slow
      CHECK(std::abs(angle(end)) < runaway_limit + hidden + top * 0.008);
    }
  }
}

TEST_CASE("a joint that its voltage brakes is proper, from any speed") {
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
      CHECK(Joint().run(0, std::min(1.0, speed / brake), angle, always(-8)) < 0);
    }
  }
}

TEST_CASE("a joint that vibrates against its voltage goes no way") {
  const auto swing = [](double s) { return 0.1 * std::sin(60 * s); };
  CHECK(Joint().run(0, 20, swing, [](double s) { return std::cos(60 * s) > 0 ? -6.0 : 6.0; }) < 0);
}

TEST_CASE("a joint with voltage that does not move is a fault after the time, sooner above half the supply") {
  for (const double volts : {3.4, 7.0, -7.0}) {
    Joint joint;
    CHECK(joint.run(0, 2, always(0.5), always(volts)) == doctest::Approx(0.168).epsilon(0.03));
    CHECK(joint.fault == MotionFault::stalled);
  }
  Joint full;
  CHECK(full.run(0, 2, always(0.5), always(-15)) == doctest::Approx(0.084).epsilon(0.04));
  Joint unchecked;
  unchecked.chosen.stall = 0;
  CHECK(unchecked.run(0, 5, always(0.5), always(15)) < 0);
}

TEST_CASE("what holds a load, moves slowly or starts late is not stalled") {
  CHECK(Joint().run(0, 60, always(0.5), always(2.9)) < 0);
  CHECK(Joint().run(0, 20, [](double s) { return 0.2 * s; }, always(10)) < 0);
  CHECK(Joint().run(0, 1, [](double s) { return s < 0.06 ? 0 : 3 * (s - 0.06); }, always(15)) < 0);
  const auto dips = [](double s) { return std::fmod(s, 0.1) < 0.02 ? 1.0 : 6.0; };
  CHECK(Joint().run(0, 20, always(0.5), dips) > 0);
  const auto pulses = [](double s) { return std::fmod(s, 0.2) < 0.1 ? 5.0 : 1.0; };
  CHECK(Joint().run(0, 20, always(0.5), pulses) < 0);
}
