// Arms with fewer joints through the whole firmware: what is not there says nothing and gets no voltage.
#include "bench.h"

using bench::Bench;
using bench::board;

namespace {

// The first two joints are in use.
params::Table two_joints() {
  params::Table table = bench::defaults();
  for (int i = 2; i < 4; ++i) table.leader[i].scale = table.follower[i].scale = 0;
  return table;
}

params::Table no_leaders() {
  params::Table table = bench::unwatched();
  for (auto& pot : table.leader) pot.scale = 0;
  return table;
}

// The inputs of the joints that are not there, open: they read anything.
void stir(Bench& arm, unsigned now) {
  for (const int pot : {2, 3, 6, 7}) {
    arm.set_count(static_cast<std::uint8_t>(pot), static_cast<std::uint16_t>(now % 3 == 0   ? 0
                                                                             : now % 3 == 1 ? 1023
                                                                                            : now * 7919 % 1024));
  }
}

}  // namespace

TEST_CASE("two joints follow while the inputs of the other two are open, whatever those read") {
  Bench arm(two_joints());
  arm.speed = 2;
  stir(arm, 0);
  REQUIRE(arm.enable() == wire::State::soft_start);
  for (unsigned i = 0; i < 4000; ++i) {
    stir(arm, i);
    arm.set_leader(0, 0.3 * std::sin(0.002 * i));
    arm.set_leader(1, -0.2 * std::sin(0.001 * i));
    arm.tick();
    REQUIRE(board.drivers);
    CHECK(board.duty[2] == 0);
    CHECK(board.duty[3] == 0);
  }
  CHECK(arm.state() == wire::State::following);
  CHECK(std::abs(arm.follower(0) - 0.3 * std::sin(8)) < 0.1);
  CHECK(std::abs(arm.follower(1) + 0.2 * std::sin(4)) < 0.1);
}

TEST_CASE("a joint whose follower alone has no pot is not in use, whatever its leader and its limits are") {
  params::Table table = two_joints();
  table.leader[2].scale = 10734;
  table.joint[2].limit_min = 1000;  // 0 is outside
  table.joint[2].limit_max = 2000;
  Bench arm(table);
  REQUIRE(arm.enable() == wire::State::soft_start);
  for (unsigned i = 0; i < 2000; ++i) {
    arm.set_leader(2, 0.5 * std::sin(0.01 * i));
    arm.tick();
    CHECK(board.duty[2] == 0);
  }
  CHECK(arm.state() == wire::State::following);
}

TEST_CASE("without leader pots the arm starts near 0 and stays there, open inputs or not") {
  Bench arm(no_leaders());
  for (const int pot : {0, 1, 2, 3}) arm.set_count(static_cast<std::uint8_t>(pot), 0);
  for (const int joint : {0, 1, 2, 3}) arm.set_follower(static_cast<std::uint8_t>(joint), 0.1);
  arm.speed = 2;
  arm.run(5);
  REQUIRE(arm.enable() == wire::State::soft_start);
  arm.run(4000);
  CHECK(arm.state() == wire::State::following);
  for (const int joint : {0, 1, 2, 3}) CHECK(std::abs(arm.follower(static_cast<std::uint8_t>(joint))) < 0.05);
}

TEST_CASE("a host that leads cannot lead a joint that is not there") {
  Bench arm(two_joints());
  const auto begun = arm.get<wire::LeadReply>(wire::LeadRequest{1000});
  const auto nack = arm.refused(wire::LeadPointRequest{begun.next, {0, 0, 5, 0}});
  CHECK(nack.code == wire::NackCode::lead_refused);
  CHECK(nack.detail == ((2 << 8) | static_cast<int>(wire::LeadRefusal::limit)));
}
