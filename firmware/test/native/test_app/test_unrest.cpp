// Unrest through the whole firmware: pots, filter, limits, a host that leads, and what the host is told.
#include "bench.h"

using bench::Bench;
using bench::board;
using bench::Booted;

namespace {

// Shakes a follower's pot, and a leader's, until the motors go off or the time is over. The ticks that it took.
unsigned shake(Bench& arm, std::uint8_t joint, unsigned ms, double follower, double leader = 0, double hertz = 8) {
  for (unsigned t = 0; t < ms; ++t) {
    const double swing = std::sin(2 * 3.14159265358979 * hertz * t / 1000.0);
    arm.set_follower(joint, follower * swing);
    arm.set_leader(joint, leader * swing);
    arm.tick();
    if (!board.drivers) return t;
  }
  return ms;
}

params::Table with_amplitude(std::uint8_t amplitude) {
  params::Table table = bench::defaults();
  table.unrest_amplitude = amplitude;
  return table;
}

}  // namespace

TEST_CASE("unrest is seen in the soft start too") {
  params::Table table = with_amplitude(10);
  table.soft_start_ms = 10000;
  Bench arm(table);
  REQUIRE(arm.enable() == wire::State::soft_start);
  CHECK(shake(arm, 0, 5000, 0.04) < 1550);
}

TEST_CASE("the limits come from the running set; 0 turns the check off") {
  for (const int amplitude : {0, 60, 30}) {
    Bench arm(with_amplitude(static_cast<std::uint8_t>(amplitude)));
    REQUIRE(arm.enable() == wire::State::soft_start);
    CHECK((shake(arm, 2, 5000, 0.04) < 5000) == (amplitude == 30));
  }
}

TEST_CASE("a leader beyond its joint's limit is still as long as it stays there") {
  params::Table table = with_amplitude(10);
  table.joint[0].limit_max = 0;
  Bench arm(table);
  arm.set_leader(0, 0.3);
  arm.run(50);
  REQUIRE(arm.enable() == wire::State::soft_start);
  for (unsigned t = 0; t < 5000 && board.drivers; ++t) {
    arm.set_leader(0, 0.3 + 0.2 * std::sin(t / 50.0));
    arm.set_follower(0, 0.05 * std::sin(t / 20.0));
    arm.tick();
  }
  CHECK(arm.status().fault == wire::Fault::unrest);
}

TEST_CASE("while the host leads, a reference that rests is a still leader, and one that moves is not") {
  for (const int size : {8, 0}) {  // 1/1024 rad in 16 ms
    Booted arm;
    auto lead = arm.get<wire::LeadReply>(wire::LeadRequest{60000});
    for (int i = 0; i < 150 && board.drivers; ++i) {
      const auto step = static_cast<std::int8_t>(i % 20 < 10 ? size : -size);
      lead.next = arm.get<wire::LeadPointReply>(wire::LeadPointRequest{lead.next, {step, 0, 0, 0}}).next;
      shake(arm, 3, 16, 0.04, 0, 62.5);  // whole periods, so that the swing goes on
    }
    CHECK(board.drivers == (size != 0));
    if (board.drivers) CHECK(shake(arm, 3, 3000, 0.04) < 1800);
    CHECK(arm.status().fault == wire::Fault::unrest);
  }
}

namespace {

// The safe set for what runs: the controllers of the defaults with no more gain, motor and limits as they are.
params::Table hot() {
  params::Table table = bench::defaults();
  table.unrest_action = 1;
  table.joint[1].kp *= 8;
  table.joint[1].ku_mv = 9000;
  table.joint[1].motor_sign = -1;
  table.joint[3].ne_c = -1000;
  return table;
}

}  // namespace

TEST_CASE("with action 1 the safe set takes over within some ticks, in a soft start; the next unrest is the end") {
  Bench arm(hot());
  REQUIRE(arm.enable() == wire::State::soft_start);
  arm.run(1100);
  CHECK(shake(arm, 2, 3000, 0.04) < 1550);
  unsigned off = 0;
  for (; !board.drivers && off < 100; ++off) arm.tick();
  CHECK(off <= 12);
  const auto status = arm.status();
  CHECK(status.state == wire::State::soft_start);
  CHECK(status.fault == wire::Fault::unrest);
  CHECK(status.fault_where == 2);
  CHECK(status.late_ticks == 0);

  params::Table safe = hot(), defaults = bench::defaults();
  safe.joint[1].kp = defaults.joint[1].kp;
  safe.joint[3].ne_c = defaults.joint[3].ne_c;
  CHECK(arm.get<wire::HelloReply>(wire::HelloRequest{}).param_crc == params::crc(safe));

  arm.run(1100);
  CHECK(arm.state() == wire::State::following);
  CHECK(shake(arm, 2, 3000, 0.04) < 1550);
  arm.run(50);
  CHECK(arm.stopped_by(wire::Fault::unrest, 2));

  arm.apply_ok(hot());  // the host's set again, and with it another safe start
  CHECK(arm.clear_fault() == wire::State::disabled);
  REQUIRE(arm.enable() == wire::State::soft_start);
  CHECK(shake(arm, 0, 3000, 0.04) < 1550);
  arm.run(20);
  CHECK(board.drivers);
}

TEST_CASE("the lease goes on while the safe set takes over, and a stop then is a stop") {
  for (const bool stop : {true, false}) {
    Bench arm(hot());
    REQUIRE(arm.enable(2000) == wire::State::soft_start);
    CHECK(shake(arm, 2, 3000, 0.04) < 1550);
    if (stop) {
      CHECK(arm.stop() == wire::State::disabled);
      arm.run(50);
    } else {
      arm.run(20);
      CHECK(board.drivers);
      arm.run(1000);
      CHECK(arm.status().stop_reason == wire::StopReason::lease);
    }
    CHECK_FALSE(board.drivers);
  }
}

TEST_CASE("a host that leads gets no safe set: the motors stay off") {
  Bench arm(hot());
  arm.get<wire::LeadReply>(wire::LeadRequest{60000});
  CHECK(shake(arm, 2, 3000, 0.04) < 1550);
  arm.run(50);
  CHECK(arm.stopped_by(wire::Fault::unrest, 2));
}

TEST_CASE("the safe set does not start the motors while the stop is pressed, nor after a tap") {
  for (const unsigned pressed_ms : {1u, 100u}) {
    params::Table table = bench::defaults();
    table.estop_input = 1;
    table.unrest_action = 1;
    Bench arm(table);
    arm.run(2);
    REQUIRE(arm.enable() == wire::State::soft_start);
    arm.run(1001);
    for (unsigned t = 0; board.drivers && t < 3000; ++t) {
      arm.set_follower(1, 0.05 * std::sin(0.05 * t));
      arm.tick();
    }
    REQUIRE_FALSE(board.drivers);
    arm.set_follower(1, 0);
    board.estop_low = true;
    arm.run(pressed_ms);
    board.estop_low = false;
    arm.run(100);
    CHECK(arm.stopped_by(wire::Fault::estop));
  }
}
