// Unrest: what swings a joint may make while the leader is still, and that a leader that moves makes none.
#include <doctest/doctest.h>
#include <supervisor.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

using namespace supervisor;

namespace {

constexpr double q12 = 4096.0, pi = 3.14159265358979;
constexpr UnrestLimits limits = {10, 6, 10};  // 10 mrad, 6 turns in a second, 1 s
constexpr Limits others = {3277, 0, 1, 100};

using Course = std::function<double(double)>;  // rad at a time in s

double still(double) { return 0.3; }

Course swing(double amplitude, double hertz, double phase = 0) {
  return [=](double s) { return amplitude * std::sin(2 * pi * hertz * s + phase); };
}

struct Arm : Supervisor {
  explicit Arm(const UnrestLimits& unrest = limits) {
    set_limits(others);
    set_unrest_limits(unrest);
    begin(false, true);
    for (int i = 0; i < 20; ++i) tick({});
    REQUIRE(enable(0, {}, {}).refusal == NackCode::none);
  }

  // Joint 2 has this leader and this error, all others are at rest. The time in s of the fault, or -1.
  double run(double seconds, const Course& leader, const Course& error) {
    for (const auto end = static_cast<unsigned>(now + seconds * 1000); now < end; ++now) {
      tick({});
      const auto joint = static_cast<std::uint8_t>(now % 4);
      const double s = now / 1000.0;
      const bool moves = joint == 2;
      look_at(joint, moves ? leader(s) : 0, moves ? error(s) : 0);
      if (fault() != Fault::none) return s;
    }
    return -1;
  }

  void look_at(std::uint8_t joint, double leader, double error) {
    const auto reference = std::lround(q12 * leader), apart = std::lround(q12 * error);
    look_at_joint(joint, {static_cast<std::int16_t>(reference - apart), static_cast<std::int16_t>(apart), 0, 0}, {});
  }

  unsigned now = 0;  // ms
};

}  // namespace

TEST_CASE("a joint that swings while the leader is still is off after the time and less than two slots more") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> size(0.0115, 0.3), hertz(6.1 / 2, 25), turn(0, 2 * pi);
  for (int trial = 0; trial < 500; ++trial) {
    Arm arm;
    arm.now = static_cast<unsigned>(random() % 1000);
    const double begin = arm.now / 1000.0, amplitude = size(random), f = hertz(random);
    const double end = arm.run(3, still, swing(amplitude, f, turn(random)));
    CAPTURE(amplitude);
    CAPTURE(f);
    REQUIRE(end >= 0);
    CHECK(arm.fault() == Fault::unrest);
    CHECK(arm.fault_where() == 2);
    CHECK_FALSE(arm.motors_on());
    CHECK(end - begin > 1.0);
    CHECK(end - begin < 1.0 + 3.0 / 6);
  }
}

TEST_CASE("swings that are too small or too slow are no unrest") {
  CHECK(Arm().run(20, still, swing(0.0095, 8)) < 0);
  CHECK(Arm().run(20, still, swing(0.2, 2.4)) < 0);
  CHECK(Arm().run(20, still, [](double s) { return 0.02 * s; }) < 0);
}

TEST_CASE("swings that end within the time are no unrest, however often they come") {
  const auto bursts = [](double s) { return std::fmod(s, 1.4) < 0.75 ? swing(0.1, 8)(s) : 0; };
  CHECK(Arm().run(30, still, bursts) < 0);
}

TEST_CASE("an error that swings about any place is seen, also about the ends of its range") {
  for (const double place : {-7.9, -1.0, 0.0, 0.125, 2.5, 7.9}) {
    CHECK(Arm().run(3, still, [=](double s) { return place + swing(0.05, 6)(s); }) > 1.0);
  }
}

TEST_CASE("swings that die away are the end of a step, however long they take; those that grow are not") {
  const auto from = [](double size, double rate) {
    return [=](double s) { return size * std::exp(rate * s) * swing(1, 5)(s); };
  };
  for (const double rate : {-0.9, -1.5, -3.0}) CHECK(Arm().run(6, still, from(0.4, rate)) < 0);
  CHECK(Arm().run(6, still, from(0.1, -0.1)) > 1.0);
  CHECK(Arm().run(6, still, from(0.01, 0.5)) > 1.0);
}

TEST_CASE("a large swing with small ones in between does not die away") {
  const auto both = [](double s) { return swing(0.08, 3.5)(s) + swing(0.05, 15)(s); };
  CHECK(Arm().run(6, still, both) > 1.0);
}

TEST_CASE("property: a leader that moves by more than the amplitude every second raises nothing") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  for (int trial = 0; trial < 300; ++trial) {
    // The error is as bad as it can be: it swings all the time. The leader is drawn from what people and hosts do.
    const Course error = swing(0.02 + share(random), 3.2 + 20 * share(random), 6 * share(random));
    const double size = 0.0115 + share(random) * share(random) * 2, f = 1.5 + 8 * share(random) * share(random);
    const double speed = 0.07 + 2 * share(random), phase = 6 * share(random);
    const Course leaders[] = {
        swing(size, f, phase),
        [=](double s) { return speed * s > 7.9 ? 7.9 - std::fmod(speed * s, 7.9) : speed * s; },
        [=](double s) { return std::fmod(s * f, 1.0) < 0.5 ? size : -size; },  // jumps
        [=](double s) { return std::floor(s * 1.3) * 0.05; },
    };
    for (const Course& leader : leaders) {
      CAPTURE(trial);
      CHECK(Arm().run(3, leader, error) < 0);
    }
  }
}

TEST_CASE("property: a leader alone raises nothing, whatever it does, when the follower is at rest") {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> share(0, 1);
  for (int trial = 0; trial < 300; ++trial) {
    const double size = std::pow(10.0, -3.5 + 4 * share(random)), f = 30 * share(random), drift = 0.1 * share(random);
    const double noise = 0.003 * share(random);
    std::normal_distribution<double> draw(0, noise);
    double at = 0;
    const Course leader = [&](double s) { return at = size * std::sin(2 * pi * f * s) + drift * s + draw(random); };
    CAPTURE(size);
    CAPTURE(f);
    CHECK(Arm().run(3, leader, [&](double) { return at; }) < 0);
  }
}

TEST_CASE("swings that grow until they are too fast are unrest, and a reading that jumps once is not") {
  const MotionLimits watched = {25, 40, 32, 80, {32, 25, 0}};
  for (const bool swings : {true, false}) {
    Arm arm;
    for (; arm.fault() == Fault::none && arm.now < 2000; ++arm.now) {
      const double s = arm.now / 1000.0, error = swings ? 0.02 * std::exp(4 * s) * std::sin(55 * s) : s < 0.8 ? 0 : 0.2;
      const auto apart = static_cast<std::int16_t>(std::lround(q12 * error));
      const auto joint = static_cast<std::uint8_t>(arm.now % 4);
      arm.look_at_joint(joint, {static_cast<std::int16_t>(-apart), apart, 0, 0}, watched);
    }
    CHECK(arm.now < 1000);
    CHECK(arm.fault() == (swings ? Fault::unrest : Fault::speed));
  }
}

TEST_CASE("what swings while the joint is held back is not its controller's doing") {
  const MotionLimits watched = {0, 0, 32, 80, {32, 25, 0}};
  for (const int volts_mv : {8000, 1000}) {
    Arm arm;
    for (; arm.fault() == Fault::none && arm.now < 4000; ++arm.now) {
      const auto apart = static_cast<std::int16_t>(std::lround(q12 * (0.5 + swing(0.02, 5)(arm.now / 1000.0))));
      const auto joint = static_cast<std::uint8_t>(arm.now % 4);
      const auto mv = static_cast<std::int16_t>(volts_mv);
      arm.look_at_joint(joint, {static_cast<std::int16_t>(-apart), apart, mv, 0}, watched);
    }
    CHECK(arm.motors_on() == (volts_mv > 3200));
  }
}

TEST_CASE("the other joints' leaders count too, and the time begins when the last of them rests") {
  Arm arm;
  for (; arm.now < 6000; ++arm.now) {
    const auto joint = static_cast<std::uint8_t>(arm.now % 4);
    const double s = arm.now / 1000.0;
    const double leader = joint == 0 && s < 2 ? swing(0.05, 1)(s) : 0;
    arm.look_at(joint, leader, joint == 3 ? swing(0.05, 8)(s) : 0);
    if (arm.fault() != Fault::none) break;
  }
  CHECK(arm.fault_where() == 3);
  CHECK(arm.now >= 2900);
  CHECK(arm.now < 3500);
}

TEST_CASE("a limit of 0 turns the check off, and other limits have other times") {
  CHECK(Arm({0, 6, 10}).run(20, still, swing(0.2, 8)) < 0);
  for (const int rate : {1, 6, 7, 10}) {
    for (const int tenths : {2, 13, 60}) {
      const double end =
          Arm({10, static_cast<std::uint8_t>(rate), static_cast<std::uint8_t>(tenths)}).run(20, still, swing(0.1, 12));
      CHECK(end >= tenths / 10.0);
      CHECK(end < 1.05 * tenths / 10.0 + 3.1 / rate);  // a slot is a whole number of looks
    }
  }
}

TEST_CASE(
    "the motors' start begins anew, nothing is watched while they are off, and the fault can be cleared at once") {
  Arm arm;
  CHECK(arm.run(0.9, still, swing(0.1, 8)) < 0);
  arm.stop();
  CHECK(arm.run(5, still, swing(0.1, 8)) < 0);
  REQUIRE(arm.enable(0, {}, {}).refusal == NackCode::none);
  CHECK(arm.run(0.95, still, swing(0.1, 8)) < 0);
  CHECK(arm.run(0.6, still, swing(0.1, 8)) > 0);
  CHECK(arm.stop_reason() == StopReason::fault);
  CHECK(arm.enable(0, {}, {}).refusal == NackCode::in_fault);
  CHECK(arm.clear_fault({}, {}).refusal == NackCode::none);
  CHECK(arm.enable(0, {}, {}).refusal == NackCode::none);
}
