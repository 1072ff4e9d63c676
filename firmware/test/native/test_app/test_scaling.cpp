// The leader's motion scaled, smoothed, and moved on by the clutch.
#include "bench.h"

using bench::Bench;
using bench::board;

namespace {

constexpr double count = 1 / bench::count_per_rad;  // rad, of a 10-bit potentiometer
constexpr double clutch_step = 1.0 / 1024;          // rad, what engaging may be off by

params::Table still() {
  params::Table table = bench::unwatched();
  table.tracking_limit = 0;  // this follower stays where it is
  table.filter_shift = 0;
  return table;
}

// The same, and it can be enabled anywhere.
params::Table free() {
  params::Table table = still();
  table.enable_limit = 25722;  // 6.28 rad
  return table;
}

params::Table scaled(double ratio) {
  params::Table table = free();
  for (auto& joint : table.scaling) joint.ratio = static_cast<std::uint8_t>(std::lround(ratio * 64));
  return table;
}

struct Scaled : Bench {
  explicit Scaled(const params::Table& table) : Bench(table) { get<wire::TelemetryReply>(wire::TelemetryRequest{1}); }
  // Of a joint after some ticks, rad
  double reference(std::uint8_t joint = 0, unsigned after = 2) {
    run(after);
    return samples.back().leader[joint] / 4096.0;
  }
  wire::Clutch clutch(wire::ClutchAction action) { return get<wire::ClutchReply>(wire::ClutchRequest{action}).clutch; }
  wire::Clutch disengage() { return clutch(wire::ClutchAction::disengage); }
  wire::Clutch engage() { return clutch(wire::ClutchAction::engage); }
};

}  // namespace

TEST_CASE("the reference is the leader's angle times its joint's ratio, within the joint's limits") {
  params::Table table = free();
  const double ratios[] = {6 / 64.0, 0.5, 1, 3};
  for (std::uint8_t i = 0; i < 4; ++i) table.scaling[i].ratio = static_cast<std::uint8_t>(ratios[i] * 64);
  Scaled arm(table);
  arm.enable();
  for (const double angle : {-2.0, -0.7, 0.0, 0.4, 1.1}) {
    for (std::uint8_t i = 0; i < 4; ++i) arm.set_leader(i, angle);
    for (std::uint8_t i = 0; i < 4; ++i) {
      const double wanted = std::max(-2.5, std::min(2.5, angle * ratios[i]));
      CHECK(std::abs(arm.reference(i) - wanted) <= ratios[i] * count / 2 + 1 / 4096.0);
    }
  }
}

TEST_CASE("with a ratio of 1, no filter and no clutch the leader's angle is the reference within its own tick") {
  Scaled arm(still());
  arm.set_leader(0, 0.8);
  CHECK(std::abs(arm.reference(0, 1) - 0.8) < count);
  Scaled half(scaled(0.5));
  half.enable();
  half.set_leader(0, 0.8);
  CHECK(std::abs(half.reference(0, 1)) < count);  // a tick later
  CHECK(std::abs(half.reference(0, 1) - 0.4) < count);
}

TEST_CASE("while the clutch is disengaged the reference rests; engaged it goes on from there without a jump") {
  for (const double ratio : {0.25, 1.0, 3.0}) {
    Scaled arm(scaled(ratio));
    arm.set_leader(0, 0.2);
    arm.set_follower(0, 0.2 * ratio);
    arm.run(5);
    arm.enable();
    const double rests = arm.reference();
    CHECK(arm.disengage() == wire::Clutch::disengaged);
    CHECK(arm.status().clutch == wire::Clutch::disengaged);
    for (const double angle : {1.5, -2.4, -1.0}) {
      arm.set_leader(0, angle);
      CHECK(arm.reference() == rests);
    }
    arm.engage();
    CHECK(arm.status().clutch == wire::Clutch::shifted);
    CHECK(std::abs(arm.reference() - rests) <= clutch_step);
    arm.set_leader(0, -1.3);
    CHECK(std::abs(arm.reference() - (rests - 0.3 * ratio)) <= ratio * count + clutch_step);
    CHECK(board.drivers);
  }
}

TEST_CASE("a shifted reference of the largest ratio stays at its limit when its leader goes all the way") {
  params::Table table = scaled(3);
  for (auto& joint : table.joint) joint.limit_min = -25722, joint.limit_max = 25722;  // 6.28 rad
  table.leader[0].scale = 16384;
  Scaled arm(table);
  arm.disengage();
  arm.set_count(0, 8);
  arm.set_follower(0, 2.5);
  arm.run(4);
  arm.enable();
  REQUIRE(arm.engage() == wire::Clutch::shifted);
  double before = arm.reference();
  for (unsigned c = 8; c <= 1015; c += 7) {
    arm.set_count(0, static_cast<std::uint16_t>(c));
    const double now = arm.reference();
    CHECK(now >= before);
    before = now;
  }
  CHECK(before == doctest::Approx(6.28).epsilon(0.001));
}

TEST_CASE("disengaged, the arm can be enabled wherever the leader is, and engaged there") {
  Scaled arm(still());
  arm.set_leader(0, 2.0);
  arm.set_follower(0, -1.0);
  arm.run(3);
  CHECK(arm.refused(wire::EnableRequest{0}).code == wire::NackCode::error_too_large);
  arm.disengage();
  arm.run(2);
  CHECK(arm.enable() == wire::State::soft_start);
  CHECK(std::abs(arm.reference() + 1.0) < count);
  arm.engage();
  CHECK(std::abs(arm.reference() + 1.0) < count);
  arm.set_leader(0, 1.5);
  CHECK(std::abs(arm.reference() + 1.5) < 2 * count);
}

TEST_CASE("a reset gives the leader's own angle back, only while the motors are off") {
  Scaled arm(still());
  arm.set_leader(0, 2.0);
  arm.disengage();
  arm.run(2);
  arm.enable();
  arm.engage();
  CHECK(arm.refused(wire::ClutchRequest{wire::ClutchAction::reset}).code == wire::NackCode::not_disabled);
  arm.stop();
  CHECK(arm.status().clutch == wire::Clutch::shifted);
  CHECK(arm.clutch(wire::ClutchAction::reset) == wire::Clutch::engaged);
  CHECK(arm.refused(wire::EnableRequest{0}).code == wire::NackCode::error_too_large);
}

TEST_CASE("the pedal disengages while it is pressed: one that closes, one that opens, or none") {
  for (std::uint8_t input = 0; input <= 2; ++input) {
    params::Table table = still();
    table.clutch_input = input;
    board.clutch_low = false;
    Scaled arm(table);
    for (const bool low : {true, false, true}) {
      board.clutch_low = low;
      arm.run(2);
      const bool pressed = input != 0 && low == (input == 1);
      CHECK((arm.status().clutch == wire::Clutch::disengaged) == pressed);
      if (pressed) CHECK(arm.engage() == wire::Clutch::disengaged);  // the pedal is stronger
    }
  }
}

TEST_CASE("a shift outlives a fault, a new set and a host that leads") {
  Scaled arm(still());
  arm.set_leader(0, 1.0);
  arm.disengage();
  arm.run(2);
  arm.engage();
  arm.run(2);
  arm.enable();
  board.estop_low = true;
  arm.run(2);
  board.estop_low = false;
  arm.run(2);
  arm.clear_fault();
  arm.apply_ok(still());
  arm.run(2);
  arm.get<wire::LeadReply>(wire::LeadRequest{1000});
  arm.set_leader(0, 1.2);
  CHECK(std::abs(arm.reference()) < count);
  arm.stop();
  arm.enable();
  CHECK(std::abs(arm.reference() - 0.2) < 2 * count);
}

TEST_CASE("the tremor filter is a low-pass of 2^tremor_shift ticks, while the motors are on") {
  params::Table table = still();
  table.tremor_shift = 5;
  Scaled arm(table);
  arm.set_leader(0, 0.5);
  arm.set_follower(0, 0.5);
  arm.run(2);
  arm.enable();
  const double at = arm.reference(0, 1);  // with the motors off it was there at once
  CHECK(std::abs(at - 0.5) < count);
  arm.set_leader(0, -0.5);
  const double to = std::lround(-0.5 * bench::count_per_rad + 511.5) * count - 511.5 * count;
  double left = at - to;
  CHECK(arm.reference(0, 1) == at);
  for (int tick = 0; tick < 200; ++tick) {
    left *= 31 / 32.0;
    REQUIRE(std::abs(arm.reference(0, 1) - to - left) < 2 / 4096.0);
  }
}
