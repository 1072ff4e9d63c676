// The parameter table: index order, ranges, defaults, CRC, contradictions, staging.
#include <doctest/doctest.h>

#include <string.h>

#include <cmath>
#include <vector>

#include "../test_link/expect.h"
#include "../test_link/golden.h"
#include "params/params.h"

namespace {

// Flat indices as docs/link.md has them.
constexpr uint16_t joint_at = 8;
constexpr uint16_t joint_fields = 15;
constexpr uint16_t leader_at = joint_at + 4 * joint_fields;
constexpr uint16_t follower_at = leader_at + 8;

int32_t value_of(const params::Table& table, uint16_t index) {
  int32_t value = 0;
  EXPECT(params::get(table, index, value) == params::Access::ok);
  return value;
}

params::Table defaults() {
  params::Table table;
  params::load_defaults(table);
  return table;
}

bool same(const params::Table& a, const params::Table& b) { return memcmp(&a, &b, sizeof(a)) == 0; }

}  // namespace

TEST_CASE("defaults are the golden bytes with the golden CRC, valid as they stand") {
  const params::Table table = defaults();
  REQUIRE(sizeof(table) == sizeof(golden::default_table));
  CHECK(memcmp(&table, golden::default_table, sizeof(table)) == 0);
  CHECK(params::crc(table) == golden::default_crc);
  CHECK(params::first_invalid(table) == params::none);
}

TEST_CASE("defaults are the paper's controllers before tuning") {
  const params::Table table = defaults();
  const double gains[4][4] = {{0.513, 0.160, 0.313, 15.0},
                              {0.590, 0.147, 0.201, 11.55},
                              {0.630, 0.244, 0.251, 13.15},
                              {0.782, 0.169, 0.233, 14.5}};
  for (int j = 0; j < 4; ++j) {
    const params::JointParameters joint = table.joint[j];
    CHECK(joint.kp == std::lround(gains[j][0] * 65536));
    CHECK(joint.kd == std::lround(gains[j][1] * 65536));
    CHECK(joint.ki == std::lround(gains[j][2] * 65536));
    CHECK(joint.ku_mv == std::lround(gains[j][3] * 1000));
    CHECK(joint.ne_c == std::lround(-0.3 * 16384));
    CHECK(joint.ze_a == std::lround(-0.3 * 16384));
    CHECK(joint.ze_c == std::lround(0.3 * 16384));
    CHECK(joint.pe_b == std::lround(0.3 * 16384));
    CHECK(joint.nce_c == std::lround(-0.1 * 16384));
    CHECK(joint.zce_a == std::lround(-0.1 * 16384));
    CHECK(joint.zce_c == std::lround(0.1 * 16384));
    CHECK(joint.pce_b == std::lround(0.1 * 16384));
    CHECK(joint.motor_sign == 1);
  }
  CHECK(table.period_ms == 1);
}

TEST_CASE("flat indices reach the members they are said to") {
  params::Table table = defaults();
  REQUIRE(params::set(table, 0, 20) == params::Access::ok);
  CHECK(table.period_ms == 20);
  REQUIRE(params::set(table, joint_at + 2 * joint_fields + 8, 4194304) == params::Access::ok);
  const uint32_t kp = table.joint[2].kp;
  CHECK(kp == 4194304);
  REQUIRE(params::set(table, joint_at + 3 * joint_fields, -16384) == params::Access::ok);
  const int16_t ne_c = table.joint[3].ne_c;
  CHECK(ne_c == -16384);
  REQUIRE(params::set(table, leader_at + 2 * 1 + 1, -10734) == params::Access::ok);
  const int16_t scale = table.leader[1].scale;
  CHECK(scale == -10734);
  REQUIRE(params::set(table, follower_at + 2 * 3, 16368) == params::Access::ok);
  const uint16_t zero = table.follower[3].zero;
  CHECK(zero == 16368);
}

TEST_CASE("every parameter takes its limits, refuses one beyond, and changes nothing else") {
  const params::Table before = defaults();
  CHECK(sizeof(golden::ranges) / sizeof(golden::Range) == params::count);
  for (uint16_t index = 0; index < params::count; ++index) {
    INFO("index ", index);
    const golden::Range& range = golden::ranges[index];
    EXPECT(value_of(before, index) == range.initial);
    for (const int32_t value : {range.minimum, range.maximum, range.nonzero ? 1 : 0, range.initial}) {
      if (value < range.minimum) continue;
      params::Table table = before;
      EXPECT(params::set(table, index, value) == params::Access::ok);
      EXPECT(value_of(table, index) == value);
      EXPECT(params::set(table, index, range.initial) == params::Access::ok);
      EXPECT(same(table, before));
    }
    for (const int64_t value :
         {int64_t{range.minimum} - 1, int64_t{range.maximum} + 1, int64_t{INT32_MIN}, int64_t{INT32_MAX}}) {
      params::Table table = before;
      EXPECT(params::set(table, index, static_cast<int32_t>(value)) == params::Access::out_of_range);
      EXPECT(same(table, before));
    }
  }
}

TEST_CASE("an index beyond the table is refused, also far beyond") {
  params::Table table = defaults();
  int32_t value = 1234;
  for (const uint16_t index :
       {uint16_t{params::count}, uint16_t{255}, uint16_t{256}, uint16_t{0x8000}, uint16_t{0xFFFF}}) {
    CHECK(params::get(table, index, value) == params::Access::bad_index);
    CHECK(params::set(table, index, 1) == params::Access::bad_index);
  }
  CHECK(value == 1234);
  CHECK(same(table, defaults()));
}

TEST_CASE("values that must not be zero are refused at zero") {
  params::Table table = defaults();
  CHECK(params::set(table, joint_at + 12, 0) == params::Access::out_of_range);
  CHECK(params::set(table, joint_at + 12, -1) == params::Access::ok);
  CHECK(params::set(table, leader_at + 1, 0) == params::Access::ok);  // no such potentiometer
  CHECK(params::set(table, follower_at + 7, 0) == params::Access::ok);
}

TEST_CASE("a lower limit that is not below the upper one is found, with its index") {
  for (uint16_t joint = 0; joint < 4; ++joint) {
    const uint16_t limit_min = static_cast<uint16_t>(joint_at + joint * joint_fields + 13);
    params::Table table = defaults();
    REQUIRE(params::set(table, limit_min, 100) == params::Access::ok);
    REQUIRE(params::set(table, static_cast<uint16_t>(limit_min + 1), 100) == params::Access::ok);
    CHECK(params::first_inconsistent(table) == limit_min);
    CHECK(params::first_invalid(table) == limit_min);
    REQUIRE(params::set(table, static_cast<uint16_t>(limit_min + 1), 101) == params::Access::ok);
    CHECK(params::first_inconsistent(table) == params::none);
  }
}

TEST_CASE("a table from storage is checked range by range") {
  params::Table table = defaults();
  table.joint[1].kp = 0xFFFFFFFF;  // beyond INT32_MAX too
  CHECK(params::first_invalid(table) == joint_at + joint_fields + 8);
  CHECK(params::first_inconsistent(table) == params::none);
  table = defaults();
  table.follower[3].scale = 16385;
  CHECK(params::first_invalid(table) == follower_at + 7);
  table = defaults();
  table.period_ms = 0;
  CHECK(params::first_invalid(table) == 0);
}

TEST_CASE("staging changes nothing that runs until it is applied") {
  params::Sets sets;
  sets.begin(defaults());
  CHECK(same(sets.running(), sets.staged()));
  CHECK(sets.running_crc() == golden::default_crc);

  REQUIRE(sets.stage(0, 20) == params::Access::ok);
  REQUIRE(sets.stage(1, 12000) == params::Access::ok);
  CHECK(sets.stage(1, 1) == params::Access::out_of_range);
  CHECK(same(sets.running(), defaults()));
  CHECK(sets.running_crc() == golden::default_crc);

  sets.apply();
  CHECK(same(sets.running(), sets.staged()));
  CHECK(sets.running().period_ms == 20);
  const uint16_t supply = sets.running().supply_mv;
  CHECK(supply == 12000);
  CHECK(sets.running_crc() == params::crc(sets.running()));
  CHECK(sets.running_crc() != golden::default_crc);

  sets.stage_defaults();
  CHECK(sets.running().period_ms == 20);
  sets.apply();
  CHECK(sets.running_crc() == golden::default_crc);
}
