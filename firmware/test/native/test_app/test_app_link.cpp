// The link as App serves it: telemetry, repeated and many requests, garbage.
#include "bench.h"

using bench::Bench;
using bench::board;
using bench::Booted;

TEST_CASE("samples come every so many ticks with numbers in a row, until they are turned off") {
  for (std::uint16_t every : {std::uint16_t{1}, std::uint16_t{7}, std::uint16_t{1000}}) {
    Booted arm;
    CHECK(arm.get<wire::TelemetryReply>(wire::TelemetryRequest{every}).every == every);
    arm.run(every * 20u);
    REQUIRE(arm.samples.size() == 20);
    int wrong = 0;
    for (std::size_t i = 1; i < 20; ++i) {
      if (arm.samples[i].tick - arm.samples[i - 1].tick != every) ++wrong;
      if (static_cast<std::uint8_t>(arm.sample_seqs[i] - arm.sample_seqs[i - 1]) != 1) ++wrong;
    }
    CHECK(wrong == 0);
    arm.get<wire::TelemetryReply>(wire::TelemetryRequest{0});
    arm.samples.clear();
    arm.run(every * 3u);
    CHECK(arm.samples.empty());
  }
}

TEST_CASE("samples that find no room are dropped and counted, and their numbers stay out") {
  Booted arm;
  arm.get<wire::TelemetryReply>(wire::TelemetryRequest{1});
  arm.run(5);
  const auto sent = arm.samples.size();
  arm.drain = false;
  arm.run(20);
  arm.drain = true;
  arm.run(2);
  const auto status = arm.status();
  CHECK(status.telemetry_dropped >= 17);
  const unsigned ticks_since = status.tick - arm.samples.front().tick;
  CHECK(arm.samples.size() + status.telemetry_dropped + 1 >= ticks_since);
  CHECK(arm.samples.size() > sent);
  unsigned gap = 0;
  for (std::size_t i = 1; i < arm.samples.size(); ++i) {
    const unsigned in_ticks = arm.samples[i].tick - arm.samples[i - 1].tick;
    CHECK(static_cast<std::uint8_t>(arm.sample_seqs[i] - arm.sample_seqs[i - 1]) == in_ticks);
    gap = std::max(gap, in_ticks);
  }
  CHECK(gap >= 17);
}

TEST_CASE("a request that is repeated is answered again and changes nothing") {
  Booted arm;
  arm.frames.clear();
  for (int i = 0; i < 3; ++i) arm.send_raw(Bench::frame(wire::EnableRequest{500}, 42));
  arm.run(2);
  CHECK(arm.frames.size() == 3);
  for (const auto& frame : arm.frames) CHECK(frame.type == 0x88);
  CHECK(arm.state() == wire::State::soft_start);
}

TEST_CASE("many requests at once are all answered, in their order, a few each tick") {
  Booted arm;
  arm.frames.clear();
  for (std::uint8_t seq = 0; seq < 60; ++seq) arm.send_raw(Bench::frame(wire::StatusRequest{}, seq));
  arm.run(60);
  REQUIRE(arm.frames.size() == 60);
  int wrong = 0;
  for (std::size_t i = 0; i < 60; ++i) wrong += arm.frames[i].seq != i;
  CHECK(wrong == 0);
}

TEST_CASE("an enable frame with any one or two bits wrong does not turn the motors on") {
  const auto good = Bench::frame(wire::EnableRequest{1000}, 5);
  Booted arm;
  const auto bits = good.size() * 8;
  for (std::size_t a = 0; a < bits; ++a) {
    for (std::size_t b = a; b < bits; ++b) {  // b == a: one bit
      auto bad = good;
      bad[a / 8] = static_cast<std::uint8_t>(bad[a / 8] ^ (1u << (a % 8)));
      if (b != a) bad[b / 8] = static_cast<std::uint8_t>(bad[b / 8] ^ (1u << (b % 8)));
      arm.send_raw(bad);
      arm.send_raw({0});
      arm.service();
      board.tx_room = hal::tx_capacity;
      REQUIRE_FALSE(board.drivers);
    }
  }
  arm.run(2);
  CHECK(arm.enable() == wire::State::soft_start);  // the whole one does
}
