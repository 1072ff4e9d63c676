// Sampling against its definition, over its whole range.
#include <sampling.h>

#include "bench.h"

namespace {

// The definition: ((count14 - zero) * scale + 4096) >> 13
int angle_of(int sum, int zero, int scale) {
  const long long product = static_cast<long long>(sum * 4 - zero) * scale + 4096;
  return static_cast<int>(product >= 0 ? product / 8192 : -((-product + 8191) / 8192));
}

void tick(app::Sampling& sampling, const std::uint16_t* sums, supervisor::Observation& seen) {
  sampling.tick(sums, seen);
  sampling.prepare_low_passes();
}

}  // namespace

TEST_CASE("the filter reaches a step from both sides, never overshoots, and its first sample is taken whole") {
  for (std::uint8_t shift = 0; shift <= 4; ++shift) {
    for (const int from : {0, 1000, 4092}) {
      for (const int to : {0, 997, 4092}) {
        params::Table table = bench::defaults();
        table.filter_shift = shift;
        app::Sampling sampling;
        supervisor::Observation seen = {};
        sampling.configure(table);
        std::uint16_t sums[8];
        std::fill(sums, sums + 8, static_cast<std::uint16_t>(from));
        tick(sampling, sums, seen);
        CHECK(sampling.leader(0) == angle_of(from, 8184, 10734));
        std::fill(sums, sums + 8, static_cast<std::uint16_t>(to));
        const int goal = angle_of(to, 8184, 10734);
        int before = std::abs(sampling.leader(0) - goal), worse = 0;
        for (int i = 0; i < 300; ++i) {
          tick(sampling, sums, seen);
          const int now = sampling.leader(0) - goal;
          if ((from < to) ? now > 0 : now < 0) ++worse;
          if (std::abs(now) > before) ++worse;
          before = std::abs(now);
        }
        CHECK(worse == 0);
        CHECK(before <= 3);  // half of the filter's smallest step, 8/64 of a 10-bit count
      }
    }
  }
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
