// A leader's potentiometer that jumps turns the motors off, while that leader leads.
#include "bench.h"

using bench::Bench;
using bench::board;

namespace {

params::Table watched(double ratio = 1) {
  params::Table table = bench::unwatched();
  table.speed_limit = 25;
  table.tracking_limit = 0;  // this follower stays where it is
  table.enable_limit = 25722;
  for (auto& joint : table.scaling) joint.ratio = static_cast<std::uint8_t>(std::lround(ratio * 64));
  return table;
}

struct Watched : Bench {
  explicit Watched(const params::Table& table = watched()) {
    boot_with(table);
    run(10);
  }
  Watched& on() {
    enable();
    run(20);
    REQUIRE(board.drivers);
    return *this;
  }
  // The motors are off, because of this leader, within two looks at it.
  bool stops(std::uint8_t joint, double angle) {
    set_leader(joint, angle);
    run(8);
    return stopped_by(wire::Fault::leader_jump, joint);
  }
  void clutch(wire::ClutchAction action) { get<wire::ClutchReply>(wire::ClutchRequest{action}); }
};

}  // namespace

TEST_CASE("a leader that jumps turns the motors off, and the fault names its potentiometer") {
  for (std::uint8_t joint = 0; joint < 4; ++joint) {
    for (const double jump : {0.3, -1.0, 2.4}) CHECK(Watched().on().stops(joint, jump));
  }
  Watched again;
  CHECK(again.on().stops(2, 1.0));
  CHECK(again.clear_fault() == wire::State::disabled);
  again.on().run(200);
  CHECK(board.drivers);
}

TEST_CASE("two leaders that jump at once are one fault; outside the joint's limits it is one as well") {
  Watched both;
  both.on();
  both.set_leader(1, 1.0);
  both.set_leader(3, 1.0);
  both.run(8);
  const auto now = both.status();
  CHECK(now.fault == wire::Fault::leader_jump);
  CHECK(now.fault_where % 2 == 1);

  params::Table narrow = watched();
  narrow.joint[0].limit_max = 4096;  // 1 rad
  Watched beyond(narrow);
  beyond.set_leader(0, 1.2);
  beyond.run(20);
  CHECK(beyond.on().stops(0, 2.2));
}

TEST_CASE("a ratio or a tremor filter hides no jump and makes none of a hand's motion") {
  for (const double ratio : {0.25, 3.0}) CHECK(Watched(watched(ratio)).on().stops(0, 0.4));
  params::Table smooth = watched();
  smooth.tremor_shift = 8;
  CHECK(Watched(smooth).on().stops(0, 1.0));

  Watched quick(watched(3));
  quick.on();
  for (int ms = 0; ms < 200; ++ms) {
    quick.set_leader(0, 0.8 * std::sin(ms * 0.001 * 25));  // 20 rad/s, so 60 rad/s of the reference
    quick.tick();
  }
  CHECK(board.drivers);
}

TEST_CASE("a leader that does not lead may jump: disengaged, while the host leads, motors off, and where none is") {
  Watched disengaged;
  disengaged.on().clutch(wire::ClutchAction::disengage);
  disengaged.set_leader(0, 2.0);
  disengaged.run(100);
  disengaged.clutch(wire::ClutchAction::engage);
  disengaged.run(20);
  CHECK(board.drivers);
  CHECK(disengaged.stops(0, 0.5));

  Watched led;
  led.get<wire::LeadReply>(wire::LeadRequest{60000});
  led.run(20);
  led.set_leader(0, 2.0);
  led.run(20);
  CHECK(board.drivers);

  Watched off;
  off.set_leader(0, 1.0);
  off.run(20);
  CHECK(off.state() == wire::State::disabled);
  off.on().run(20);
  CHECK(board.drivers);

  params::Table fewer = watched();
  fewer.follower[2].scale = 0;
  Watched three(fewer);
  three.on().set_leader(2, 1.5);
  three.run(20);
  CHECK(board.drivers);
}

TEST_CASE("another calibration right before the start is no jump") {
  Watched arm;
  params::Table moved = watched();
  for (auto& pot : moved.leader) pot.zero = static_cast<std::uint16_t>(pot.zero - 3000);  // 1 rad
  arm.apply_ok(moved);
  arm.tick();
  arm.enable();
  arm.run(20);
  CHECK(board.drivers);
}

TEST_CASE("with a speed_limit of 0 a leader may jump") {
  params::Table table = watched();
  table.speed_limit = 0;
  Watched arm(table);
  arm.on().set_leader(0, 2.0);
  arm.run(100);
  CHECK(board.drivers);
}
