// Sampling against its definition, over its whole range.
#include <sampling.h>

#include "bench.h"

namespace {

void tick(app::Sampling& sampling, const std::uint16_t* sums, supervisor::Observation& seen) {
  sampling.tick(sums, seen);
  sampling.prepare_low_passes();
}

}  // namespace

TEST_CASE("the first sample of a set is taken whole, and those after it through the filter") {
  params::Table table = bench::defaults();
  table.filter_shift = 4;
  table.leader[0] = {8184, 8192};  // count14, from 8184 on
  app::Sampling sampling;
  supervisor::Observation seen = {};
  sampling.configure(table);
  const std::uint16_t at_rest[8] = {1000}, moved[8] = {2000};
  tick(sampling, at_rest, seen);
  CHECK(sampling.leader(0) == 4000 - 8184);
  tick(sampling, moved, seen);
  CHECK(sampling.leader(0) == 4000 + 4000 / 16 - 8184);
}

TEST_CASE("an error is that from the follower to the leader within its joint's limits, and a distance is its size") {
  params::Table table = bench::defaults();
  table.filter_shift = 0;
  int wrong = 0;
  for (std::uint8_t joint = 0; joint < 4; ++joint) {
    table.leader[joint] = {8184, 16384};  // twice count14
    table.follower[joint] = {8184, -16384};
    table.joint[joint].limit_min = static_cast<std::int16_t>(-1000 * (joint + 1));
    table.joint[joint].limit_max = static_cast<std::int16_t>(700 * (joint + 2));
  }
  app::Sampling sampling;
  supervisor::Observation seen = {};
  sampling.configure(table);
  for (int step = 0; step <= 4092; step += 11) {
    std::uint16_t sums[8];
    for (int i = 0; i < 8; ++i) sums[i] = static_cast<std::uint16_t>((step * (i + 1)) % 4093);
    tick(sampling, sums, seen);
    for (std::uint8_t i = 0; i < 4; ++i) {
      const int leader = (sums[i] * 4 - 8184) * 2, follower = (8184 - sums[i + 4] * 4) * 2;
      const int wanted = std::max<int>(table.joint[i].limit_min, std::min<int>(table.joint[i].limit_max, leader));
      wrong += sampling.leader(i) != leader;
      wrong += sampling.error(i) != wanted - follower;
      wrong += sampling.follower(i) != follower;
      wrong += sampling.distance(i) != std::abs(wanted - follower);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("rails are flagged per pot on the raw reading, and rail_counts 0 turns them off") {
  params::Table table = bench::defaults();
  app::Sampling sampling;
  supervisor::Observation seen = {};
  sampling.configure(table);
  for (std::uint8_t pot = 0; pot < 8; ++pot) {
    std::uint16_t sums[8];
    std::fill(sums, sums + 8, static_cast<std::uint16_t>(2048));
    const auto bit = 1u << pot;
    for (const int sum : {0, 15, 16, 17, 4075, 4076, 4077, 4092}) {
      sums[pot] = static_cast<std::uint16_t>(sum);
      tick(sampling, sums, seen);
      CHECK(seen.rail_low == (sum <= 16 ? bit : 0u));     // 4 counts x 4 conversions
      CHECK(seen.rail_high == (sum >= 4076 ? bit : 0u));  // 1019 x 4
    }
  }
  table.rail_counts = 0;
  sampling.configure(table);
  std::uint16_t sums[8] = {0, 4092, 0, 4092, 0, 4092, 0, 4092};
  tick(sampling, sums, seen);
  CHECK(seen.rail_low == 0);
  CHECK(seen.rail_high == 0);
}
