// The emergency stop through the whole firmware: its three settings, what the host is told, and what it may do.
#include "bench.h"

using bench::Bench;
using bench::board;
using bench::Following;

namespace {

params::Table with_input(std::uint8_t input) {
  params::Table table = bench::defaults();
  table.estop_input = input;
  return table;
}

}  // namespace

TEST_CASE("a board without a button starts, and a button that closes turns the motors off in the same tick") {
  Following arm;
  board.estop_low = true;
  arm.tick();
  CHECK(arm.stopped_by(wire::Fault::estop));
  CHECK(arm.refused(wire::ClearFaultRequest{}).code == wire::NackCode::estop_pressed);
  board.estop_low = false;
  arm.tick();
  CHECK(arm.clear_fault() == wire::State::disabled);
  CHECK(arm.enable() == wire::State::soft_start);
}

TEST_CASE("a button that opens stops when its input is high") {
  Bench arm(with_input(2));
  arm.run(2);
  CHECK(arm.status().fault == wire::Fault::estop);
  board.estop_low = true;
  arm.tick();
  REQUIRE(arm.clear_fault() == wire::State::disabled);
  REQUIRE(arm.enable() == wire::State::soft_start);
  arm.run(50);
  CHECK(board.drivers);
  board.estop_low = false;
  arm.tick();
  CHECK_FALSE(board.drivers);
}

TEST_CASE("with estop_input 0 the pin means nothing") {
  Bench arm(with_input(0));
  board.estop_low = true;
  arm.run(2);
  REQUIRE(arm.enable() == wire::State::soft_start);
  arm.run(50);
  CHECK(board.drivers);
}

TEST_CASE("the safe set does not start the motors while the stop is pressed, nor after a tap") {
  for (const unsigned pressed_ms : {1u, 100u}) {
    params::Table table = with_input(1);
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
