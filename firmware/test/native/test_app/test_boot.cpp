// From power-on to disabled, and what a reset leaves behind.
#include <cstring>

#include "bench.h"

using bench::Bench;
using bench::board;
using bench::Booted;

TEST_CASE("nothing moves from power-on on, and hello is said once without being asked") {
  Bench arm;
  CHECK(board.watchdog_on);
  for (unsigned i = 0; i < 200; ++i) {
    arm.tick();
    REQUIRE_FALSE(board.drivers);
    REQUIRE(bench::joint_max(board.duty) == 0);
  }
  REQUIRE(arm.frames.size() == 1);
  CHECK(arm.frames[0].type == 0x81);
  CHECK(arm.frames[0].seq == 0);
}

TEST_CASE("a firmware that has not begun is nothing but zeros, so that a board needs no code to construct it") {
  static constexpr app::App arm;
  static const char zeros[sizeof arm] = {};
  CHECK(std::memcmp(&arm, zeros, sizeof arm) == 0);
}

TEST_CASE("hello tells what this firmware is") {
  Booted arm;
  const auto hello = arm.get<wire::HelloReply>(wire::HelloRequest{});
  CHECK(unsigned(hello.protocol) == unsigned(wire::protocol));
  CHECK(hello.schema_hash == std::uint32_t{wire::schema_hash});
  CHECK(hello.board == wire::Board::native);
  CHECK(hello.param_crc == params::crc(bench::defaults()));
  CHECK(hello.param_source == wire::ParamSource::defaults);
  CHECK(hello.reset_cause == wire::ResetCause::power_on);
}

TEST_CASE("requests are answered during boot, but enable is refused") {
  Bench arm;
  arm.run(2);
  CHECK(arm.state() == wire::State::boot);
  CHECK(arm.refused(wire::EnableRequest{0}).code == wire::NackCode::booting);
  arm.boot();
  const auto status = arm.status();
  CHECK(status.state == wire::State::disabled);
  CHECK(status.stop_reason == wire::StopReason::reset);
  CHECK(status.tick == arm.ticks);
}

TEST_CASE("the watchdog is fed by finished ticks and by nothing else") {
  Bench arm;
  const unsigned before = board.watchdog_kicks;
  arm.run(50);
  CHECK(board.watchdog_kicks == before + 50);
  for (int i = 0; i < 100; ++i) arm.service();
  CHECK(board.watchdog_kicks == before + 50);
}
