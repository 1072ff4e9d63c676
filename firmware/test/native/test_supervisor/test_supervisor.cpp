// The supervisor: every state meets every request and every fault.
#include <doctest/doctest.h>
#include <supervisor.h>

#include <cstdint>
#include <initializer_list>

using namespace supervisor;

namespace {

constexpr Limits limits = {3277, 10240, 500, 1000};  // 0.8 rad, 2.5 rad

// What a tick has seen, and how far apart the joints are then.
struct Seen : Observation {
  Distances distances;
};
const Seen calm = {};

Seen apart(std::uint8_t joint, std::uint16_t distance) {
  Seen seen = calm;
  seen.distances.of[joint] = distance;
  return seen;
}

Seen with_rails(std::uint8_t low, std::uint8_t high) {
  Seen seen = calm;
  seen.rail_low = low;
  seen.rail_high = high;
  return seen;
}

Seen late() {
  Seen seen = calm;
  seen.late = true;
  return seen;
}

Seen pressed() {
  Seen seen = calm;
  seen.estop = true;
  return seen;
}

struct Arm : Supervisor {
  explicit Arm(bool after_watchdog = false, bool params_ok = true) {
    set_limits(limits);
    begin(after_watchdog, params_ok);
  }
  // Ticks, each followed by the looks at the rails and at a joint. A set of limits turns the checks of the motion off.
  Arm& run(unsigned ticks, const Seen& seen = calm) {
    for (; ticks > 0; --ticks, ++now) {
      tick(seen);
      note_rails(seen.rail_low, seen.rail_high);
      const auto joint = static_cast<std::uint8_t>(now % joint_count);
      look_at_joint(joint, {0, static_cast<std::int16_t>(seen.distances.of[joint]), 0, 0}, {});
    }
    last = seen;
    return *this;
  }
  Reply enable(std::uint16_t lease) { return Supervisor::enable(lease, last, last.distances); }
  Reply clear_fault() { return Supervisor::clear_fault(last, last.distances); }
  Seen last = calm;
  unsigned now = 0;
  Arm& booted() { return run(20); }
  Arm& enabled(std::uint16_t lease = 0) {
    booted();
    REQUIRE(enable(lease).refusal == NackCode::none);
    return *this;
  }
  Arm& following() {
    enabled().run(1000);
    REQUIRE(state() == State::following);
    return *this;
  }
};

}  // namespace

TEST_CASE("boot lasts 20 ticks, ends in disabled and refuses enable until then") {
  Arm arm;
  CHECK(arm.stop_reason() == StopReason::reset);
  arm.run(19);
  CHECK(arm.state() == State::boot);
  CHECK(arm.enable(0).refusal == NackCode::booting);
  CHECK(arm.clear_fault().refusal == NackCode::booting);
  arm.run(1);
  CHECK(arm.state() == State::disabled);
  CHECK_FALSE(arm.motors_on());
}

TEST_CASE("after a watchdog reset the arm waits in fault until it is cleared") {
  Arm arm(true);
  arm.booted();
  CHECK(arm.state() == State::fault);
  CHECK(arm.fault() == Fault::watchdog);
  const Reply refused = arm.enable(0);
  CHECK(refused.refusal == NackCode::in_fault);
  CHECK(refused.detail == static_cast<unsigned>(Fault::watchdog));
  CHECK(arm.clear_fault().refusal == NackCode::none);
  CHECK(arm.state() == State::disabled);
  CHECK(arm.fault() == Fault::none);
}

TEST_CASE("a stored set that cannot run is a fault until another set is applied") {
  Arm arm(false, false);
  arm.booted();
  CHECK(arm.fault() == Fault::params);
  CHECK(arm.clear_fault().refusal == NackCode::set_lost);
  CHECK(arm.state() == State::fault);
  arm.params_mended();
  CHECK(arm.clear_fault().refusal == NackCode::none);
  CHECK(arm.state() == State::disabled);
}

TEST_CASE("enable is refused beyond the limit on any joint and names it") {
  for (std::uint8_t joint = 0; joint < 4; ++joint) {
    Arm arm;
    arm.booted().run(1, apart(joint, 3278));
    const Reply refused = arm.enable(0);
    CHECK(refused.refusal == NackCode::error_too_large);
    CHECK(refused.where == joint);
    CHECK(refused.detail == 3278);
    CHECK(arm.state() == State::disabled);
    arm.run(1, apart(joint, 3277));
    CHECK(arm.enable(0).refusal == NackCode::none);
  }
}

TEST_CASE("enable is refused while a pot is at a rail") {
  Arm arm;
  arm.booted().run(1, with_rails(1 << 5, 0));
  Reply refused = arm.enable(0);
  CHECK(refused.refusal == NackCode::pot_bad);
  CHECK(refused.where == 5);
  CHECK(refused.detail == static_cast<unsigned>(Fault::pot_low));
  arm.run(1, with_rails(0, 1 << 2));
  refused = arm.enable(0);
  CHECK(refused.where == 2);
  CHECK(refused.detail == static_cast<unsigned>(Fault::pot_high));
  CHECK(arm.state() == State::disabled);
}

TEST_CASE("a second enable ramps from zero again") {
  Arm arm;
  arm.following().stop();
  CHECK(arm.share_q15() == 0);
  CHECK(arm.enable(0).refusal == NackCode::none);
  CHECK(arm.state() == State::soft_start);
  CHECK(arm.share_q15() == 32768 / limits.soft_start_ms);
}

TEST_CASE("stop works in every state") {
  struct Case {
    Arm arm;
    State state;
    StopReason reason;
  } cases[] = {{Arm(), State::boot, StopReason::reset},
               {Arm().booted(), State::disabled, StopReason::reset},
               {Arm().enabled().run(10), State::disabled, StopReason::host},
               {Arm().following(), State::disabled, StopReason::host},
               {Arm().following().run(1, late()), State::fault, StopReason::fault}};
  for (Case& one : cases) {
    one.arm.stop();
    CHECK(one.arm.state() == one.state);
    CHECK(one.arm.stop_reason() == one.reason);
  }
}

TEST_CASE("a late tick is a fault at once while motors are on, and only then") {
  Arm arm;
  arm.booted().run(3, late());
  CHECK(arm.state() == State::disabled);
  arm.run(1);
  REQUIRE(arm.enable(0).refusal == NackCode::none);
  arm.run(1, late());
  CHECK(arm.state() == State::fault);
  CHECK(arm.fault() == Fault::late_tick);
  CHECK(arm.fault_where() == nowhere);
  CHECK_FALSE(arm.motors_on());
  CHECK(arm.clear_fault().refusal == NackCode::in_fault);  // the last tick was late
  arm.run(1);
  CHECK(arm.clear_fault().refusal == NackCode::none);
}

TEST_CASE("a pot at a rail for three ticks in a row is a fault and names the pot; two are not") {
  for (std::uint8_t pot = 0; pot < 8; ++pot) {
    for (bool high : {false, true}) {
      const auto bit = static_cast<std::uint8_t>(1u << pot);
      const Seen rail = high ? with_rails(0, bit) : with_rails(bit, 0);
      Arm arm;
      arm.following().run(2, rail).run(40).run(2, rail);
      CHECK(arm.state() == State::following);
      arm.run(1, rail);
      CHECK(arm.state() == State::fault);
      CHECK(arm.fault() == (high ? Fault::pot_high : Fault::pot_low));
      CHECK(arm.fault_where() == pot);
      const Reply refused = arm.clear_fault();
      CHECK(refused.refusal == NackCode::pot_bad);
      CHECK(refused.where == pot);
      CHECK(refused.detail == static_cast<unsigned>(arm.fault()));
      arm.run(50);
      CHECK(arm.clear_fault().refusal == NackCode::none);
    }
  }
}

TEST_CASE("a pot that comes and goes is a fault, wherever in its pattern the motors start") {
  struct Pattern {
    unsigned at_rail, of;
  };
  for (const Pattern pattern : {Pattern{2, 3}, {1, 2}, {2, 4}, {1, 4}, {2, 10}, {1, 10}}) {
    for (unsigned phase = 0; phase < pattern.of; ++phase) {
      Arm arm;
      arm.following();
      unsigned ticks = 0;
      for (; arm.motors_on() && ticks < 1000; ++ticks) {
        arm.run(1, (ticks + phase) % pattern.of < pattern.at_rail ? with_rails(0, 1 << 6) : calm);
      }
      CAPTURE(pattern.at_rail);
      CAPTURE(pattern.of);
      CHECK(arm.fault() == Fault::pot_high);
      CHECK(arm.fault_where() == 6);
      CHECK(ticks <= 10 * pattern.of / pattern.at_rail);
    }
  }
}

TEST_CASE("a reading at a rail now and then is ridden through") {
  Arm arm;
  arm.following();
  for (int i = 0; i < 2000; ++i) arm.run(16).run(1, with_rails(1 << 3, 0));
  CHECK(arm.state() == State::following);
}

TEST_CASE("tracking: beyond the limit for tracking_ms in a row, to a look") {
  Arm arm;
  arm.following().run(496, apart(3, 10241)).run(4).run(496, apart(3, 10241));
  CHECK(arm.state() == State::following);
  arm.run(4, apart(3, 10241));
  CHECK(arm.state() == State::fault);
  CHECK(arm.fault() == Fault::tracking);
  CHECK(arm.fault_where() == 3);
  CHECK(arm.clear_fault().refusal == NackCode::error_too_large);
  arm.run(1, apart(3, 10240));
  CHECK(arm.clear_fault().refusal == NackCode::none);
}

TEST_CASE("tracking: at the limit is within it, and a limit of 0 turns the check off") {
  Arm arm;
  arm.following().run(2000, apart(0, 10240));
  CHECK(arm.state() == State::following);
  Arm unwatched;
  unwatched.set_limits({3277, 0, 500, 1000});
  unwatched.following().run(2000, apart(0, 30000));
  CHECK(unwatched.state() == State::following);
}

TEST_CASE("time lost before a stop does not count after the next enable") {
  Arm arm;
  arm.following().run(400, apart(1, 20000)).stop();
  arm.run(1);
  REQUIRE(arm.enable(0).refusal == NackCode::none);
  arm.run(496, apart(1, 20000));
  CHECK(arm.motors_on());
  arm.run(4, apart(1, 20000));
  CHECK(arm.fault() == Fault::tracking);
}

TEST_CASE("a lease runs out on its tick; renew and a repeated enable start it anew; 0 never runs out") {
  Arm arm;
  arm.enabled(100).run(99);
  CHECK(arm.motors_on());
  arm.run(1);
  CHECK(arm.state() == State::disabled);
  CHECK(arm.stop_reason() == StopReason::lease);

  Arm renewed;
  renewed.enabled(100).run(99).renew(100);
  renewed.run(99);
  CHECK(renewed.motors_on());
  CHECK(renewed.enable(50).refusal == NackCode::none);
  CHECK(renewed.state() == State::soft_start);
  renewed.run(49);
  CHECK(renewed.motors_on());
  renewed.run(1);
  CHECK_FALSE(renewed.motors_on());

  Arm endless;
  endless.enabled(0).run(70000);
  CHECK(endless.state() == State::following);
}

TEST_CASE("renew never turns motors on") {
  Arm arm;
  arm.booted().renew(1000);
  arm.run(5);
  CHECK(arm.state() == State::disabled);
  Arm fault;
  fault.following().run(1, late()).renew(1000);
  CHECK(fault.state() == State::fault);
}

TEST_CASE("the first fault is the one reported") {
  Arm arm;
  arm.following().run(1, late()).run(5, with_rails(1, 0));
  CHECK(arm.fault() == Fault::late_tick);
}

TEST_CASE("the emergency stop and lost parameters act at once in every state but boot, where they wait for the end") {
  struct Case {
    Arm before;
    StopReason reason;
  } cases[] = {{Arm().booted(), StopReason::reset},
               {Arm().enabled().run(1), StopReason::fault},
               {Arm().enabled().run(500), StopReason::fault},
               {Arm().following(), StopReason::fault}};
  for (const Case& one : cases) {
    Arm stopped = one.before, lost = one.before;
    stopped.run(1, pressed());
    CHECK(stopped.fault() == Fault::estop);
    lost.lose_params();
    CHECK(lost.fault() == Fault::memory);
    for (const Arm& arm : {stopped, lost}) {
      CHECK(arm.state() == State::fault);
      CHECK(arm.fault_where() == nowhere);
      CHECK(arm.stop_reason() == one.reason);
    }
  }
  Arm boot;
  boot.run(19, pressed());
  CHECK(boot.state() == State::boot);
  boot.run(2, pressed());
  CHECK(boot.fault() == Fault::estop);
  CHECK(boot.stop_reason() == StopReason::reset);
  Arm lost;
  lost.lose_params();
  CHECK(lost.state() == State::boot);
  CHECK(lost.run(30).fault() == Fault::memory);
}

TEST_CASE("the emergency stop is latched, and neither clear_fault nor enable works while it is pressed") {
  Arm arm;
  arm.following().run(1, pressed());
  CHECK(arm.clear_fault().refusal == NackCode::estop_pressed);
  arm.run(1000);
  CHECK(arm.fault() == Fault::estop);
  CHECK(arm.enable(0).refusal == NackCode::in_fault);
  CHECK(arm.clear_fault().refusal == NackCode::none);
  arm.run(1);
  CHECK(arm.enable(0).refusal == NackCode::none);

  Arm just_pressed;
  just_pressed.booted();
  just_pressed.last = pressed();  // since the last tick
  CHECK(just_pressed.enable(0).refusal == NackCode::estop_pressed);
}

TEST_CASE("the emergency stop comes before every other fault of its tick, but leaves one that stands") {
  Seen all = pressed();
  all.late = true;
  all.rail_low = 1;
  Arm together;
  together.following().run(1, all);
  CHECK(together.fault() == Fault::estop);
  Arm later;
  later.following().run(1, late()).run(5, pressed());
  CHECK(later.fault() == Fault::late_tick);
  CHECK(later.clear_fault().refusal == NackCode::estop_pressed);
}

TEST_CASE("lost parameters stand until a set is applied") {
  Arm arm;
  arm.following().lose_params();
  CHECK(arm.clear_fault().refusal == NackCode::set_lost);
  arm.params_mended();
  CHECK(arm.clear_fault().refusal == NackCode::none);
  CHECK(arm.enable(0).refusal == NackCode::none);

  Arm late_before;
  late_before.following().run(1, late()).lose_params();
  CHECK(late_before.fault() == Fault::late_tick);
  CHECK(late_before.clear_fault().refusal == NackCode::set_lost);
}
