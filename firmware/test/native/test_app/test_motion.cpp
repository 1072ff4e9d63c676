// Enable, soft start, following, and every way to stop.
#include <initializer_list>

#include "bench.h"

using bench::Bench;
using bench::board;
using bench::Booted;
using bench::Following;

TEST_CASE("soft start: the duty stays below the ramp, and the ramp reaches the top") {
  Bench arm;
  for (std::uint8_t i = 0; i < 4; ++i) arm.set_leader(i, 0.79);  // as far as enable allows: more volts than the ramp
  arm.boot_with(bench::unwatched());
  arm.run(1);
  REQUIRE(arm.enable() == wire::State::soft_start);
  CHECK(board.drivers);
  CHECK(bench::joint_max(board.duty) == 0);
  int over = 0, at_end = 0;
  for (int ms = 1; ms <= 1000; ++ms) {
    arm.tick();
    at_end = bench::joint_max(board.duty);
    if (at_end > std::lround(bench::full_duty * ms / 1000.0)) ++over;
    if (ms == 100) CHECK(at_end > bench::full_duty * 9 / 100);  // the ramp is the limit here, not the controller
  }
  CHECK(over == 0);
  CHECK(at_end > bench::full_duty * 3 / 10);
  CHECK(arm.state() == wire::State::following);
}

TEST_CASE("a motor that turns the other way is set right by motor_sign") {
  params::Table table = bench::defaults();
  table.joint[1].motor_sign = -1;
  Bench arm(table);
  arm.set_leader(0, 0.5);
  arm.set_leader(1, 0.5);
  arm.run(30);
  REQUIRE(arm.enable() == wire::State::soft_start);
  arm.run(200);
  CHECK(board.duty[0] > 20);
  CHECK(board.duty[1] < -20);
}

TEST_CASE("stop turns the drivers off before it is answered, in soft start and in following") {
  Booted starting;
  starting.enable();
  starting.run(10);
  REQUIRE(board.drivers);
  starting.send_raw(Bench::frame(wire::StopRequest{}, 77));
  starting.service();  // no tick in between
  CHECK_FALSE(board.drivers);
  CHECK_FALSE(board.drivers_when_sending);
  CHECK(bench::joint_max(board.duty) == 0);
  starting.tick();
  CHECK(starting.status().stop_reason == wire::StopReason::host);

  Following following;
  CHECK(following.stop() == wire::State::disabled);
  CHECK_FALSE(board.drivers);
  CHECK_FALSE(board.drivers_when_sending);
}

TEST_CASE(
    "what an integral holds goes on after a host's stop below 64 ms, in another set too, but in none without Ki") {
  params::Table with = bench::unwatched();
  with.soft_start_ms = 100;
  with.joint[0].ki = 20UL << 16;
  params::Table without = with;
  without.joint[0].ki = 0;
  Bench arm(with);
  arm.set_leader(0, 0.1);
  arm.run(30);
  const auto change_to = [&arm](const params::Table& table) {
    arm.stage(table);
    arm.stop();
    arm.get<wire::ParamApplyReply>(wire::ParamApplyRequest{params::crc(table)});
  };
  const auto duty_after = [&arm](unsigned ticks, std::uint16_t lease_ms = 0) {
    arm.enable(lease_ms);
    arm.run(ticks);
    return board.duty[0];
  };
  const int fresh = duty_after(110);
  arm.run(3000);
  const int held = board.duty[0];
  REQUIRE(held > 2 * fresh);

  arm.stop();
  arm.run(63);
  CHECK(duty_after(110) >= held);
  arm.stop();
  arm.run(64);
  CHECK(duty_after(110) == fresh);
  arm.run(3000);
  with.joint[0].ki /= 2;
  change_to(with);
  CHECK(duty_after(110) >= held);
  change_to(without);
  CHECK(duty_after(110) < fresh);
  change_to(with);
  duty_after(3000, 3000);  // the lease ends it
  CHECK_FALSE(board.drivers);
  CHECK(duty_after(110) <= fresh);
}

TEST_CASE("stop is answered in every other state too, and gets through while samples fill the wire") {
  Bench boot;
  boot.run(1);
  CHECK(boot.stop() == wire::State::boot);
  Following fault;
  board.late = true;
  fault.tick();
  CHECK(fault.stop() == wire::State::fault);

  Following busy;
  busy.get<wire::TelemetryReply>(wire::TelemetryRequest{1});
  board.age_us = 900;  // the processor is busy: every tick ends late
  busy.run(10);
  CHECK(busy.stop() == wire::State::disabled);
}

TEST_CASE("behind a request none begins late until the ticks that it may delay are over; then a stop gets through") {
  for (const std::uint16_t age_us : {std::uint16_t{800}, std::uint16_t{804}}) {
    Following arm;
    board.age_us = age_us;
    arm.run(10);
    unsigned before = arm.ticks;
    CHECK(arm.state() == wire::State::following);
    CHECK(arm.ticks == before);  // at once
    CHECK(arm.stop() == wire::State::disabled);
    CHECK(arm.ticks - before == (age_us > 800 ? 5u : 0u));
    arm.run(5);
    before = arm.ticks;
    CHECK(arm.state() == wire::State::disabled);
    CHECK(arm.ticks == before);
  }
}

TEST_CASE("a late tick stops the arm at once and is counted") {
  Following arm;
  board.late = true;
  board.elapsed = 3;
  hal::fake::start_tick();
  CHECK_FALSE(board.drivers);  // the interrupt does not wait for the main loop
  arm.tick();
  CHECK(arm.stopped_by(wire::Fault::late_tick));
  CHECK(arm.status().late_ticks == 2);
}

TEST_CASE("the LED tells the states apart, a 32nd of a second later at most") {
  const auto share = [](Bench& arm) {
    int on = 0;
    arm.run(32);
    for (int i = 0; i < 1024; ++i) {
      arm.tick();
      on += board.led;
    }
    return on;
  };
  Booted arm;
  CHECK(share(arm) == 64);
  arm.enable();
  arm.run(1001);
  CHECK(share(arm) == 1024);
  board.late = true;
  arm.tick();
  CHECK(share(arm) == 512);
}

namespace {

// Bytes get lost in so many of the next ticks, one tick in each `period`; how many such ticks the motors stayed on.
int lossy_ticks(Bench& arm, int count, unsigned period) {
  for (int i = 0; i < count; ++i) {
    board.lost = 3;
    arm.tick();
    if (!board.drivers) return i;
    arm.run(period - 1);
  }
  return count;
}

}  // namespace

TEST_CASE("bytes lost in the fourth tick in a row are a flood: the motors go off, and the fault can be cleared") {
  Following arm;
  CHECK(lossy_ticks(arm, 100, 1) == 3);
  CHECK(arm.stopped_by(wire::Fault::flood));
  CHECK(arm.status().rx_overruns == 12);
  CHECK(arm.clear_fault() == wire::State::disabled);
}

TEST_CASE(
    "loss that goes on is a flood, however far apart it comes below 128 ticks; beyond that it is ridden through") {
  for (const unsigned period : {2u, 20u, 64u, 127u}) {
    Following arm;
    CHECK(lossy_ticks(arm, 600, period) < 400);
  }
  Following arm;
  CHECK(lossy_ticks(arm, 100, 128) == 100);
}

TEST_CASE("bytes lost while the motors are off do not count against the next start") {
  Booted arm;
  for (int i = 0; i < 50; ++i) {
    board.lost = 1;
    arm.tick();
  }
  CHECK(arm.status().fault == wire::Fault::none);
  REQUIRE(arm.enable() == wire::State::soft_start);
  CHECK(lossy_ticks(arm, 3, 1) == 3);
  CHECK(board.drivers);
}

TEST_CASE("while the motors are on, a reading at a rail is not taken; while they are off, it is seen as it is") {
  Following arm;
  arm.get<wire::TelemetryReply>(wire::TelemetryRequest{1});
  for (const std::uint8_t pot : {std::uint8_t{1}, std::uint8_t{6}}) {
    for (const std::uint16_t rail : std::initializer_list<std::uint16_t>{0, 1023}) {
      const std::uint16_t whole = arm.counts[pot];
      arm.set_count(pot, rail);
      arm.run(2);
      const wire::Sample& held = arm.samples.back();
      CHECK(std::abs(pot < 4 ? held.leader[pot] : held.follower[pot - 4]) < 20);
      CHECK(board.drivers);
      arm.set_count(pot, whole);
      arm.run(60);
    }
  }
  arm.stop();
  arm.set_count(6, 0);
  arm.run(30);
  CHECK(arm.samples.back().follower[2] < -10000);
}

namespace {

// Ticks until the motors are off, at most 200, while a probed pot reads so much more than in its place among the
// others.
unsigned ticks_with_probe(Bench& arm, std::uint8_t pot, int beyond) {
  board.probe_beyond[pot] = beyond;
  unsigned ticks = 0;
  for (; board.drivers && ticks < 200; ++ticks) arm.tick();
  return ticks;
}

}  // namespace

TEST_CASE("an input that reads an eighth less after ground has no wire, and its fifth reading turns the motors off") {
  for (const std::uint8_t pot : {std::uint8_t{1}, std::uint8_t{6}}) {
    for (const int lost : {8, 1}) {  // eighths of the charge
      Following arm;
      const int usual = board.counts[pot];
      CHECK(ticks_with_probe(arm, pot, -usual * lost / 8 - (lost == 1 ? 40 : 0)) <= 40);
      CHECK(arm.stopped_by(wire::Fault::pot_low, pot));
    }
  }
}

TEST_CASE("an input that the pull-ups of the others raise touches one of them, and turns the motors off as well") {
  for (const std::uint8_t pot : {std::uint8_t{1}, std::uint8_t{6}}) {
    Following arm;
    CHECK(ticks_with_probe(arm, pot, 12) <= 40);
    CHECK(arm.stopped_by(wire::Fault::pot_high, pot));
  }
}

TEST_CASE("a joint that has moved meanwhile is no such input") {
  for (const int beyond : {-60, 8}) {
    Following arm;
    CHECK(ticks_with_probe(arm, 6, beyond) == 200);
  }
}

TEST_CASE("without rails, or where no pot is, neither is looked for") {
  params::Table table = bench::unwatched();
  table.leader[2].scale = table.follower[2].scale = 0;
  Bench three(table);
  three.enable();
  CHECK(ticks_with_probe(three, 6, -board.counts[6]) == 200);
  table.rail_counts = 0;
  Bench unchecked(table);
  unchecked.enable();
  CHECK(ticks_with_probe(unchecked, 5, -board.counts[5]) == 200);
}
