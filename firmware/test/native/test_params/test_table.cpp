// The parameter table: contradictions and staging. Order, ranges, defaults and CRC are compared with the host's in
// tests/protocol.
#include <doctest/doctest.h>

#include <string.h>

#include "../test_link/golden.h"
#include "params/params.h"

namespace {

// Flat indices as docs/link.md has them.
constexpr uint16_t joint_at = 8;
constexpr uint16_t joint_fields = 15;

params::Table defaults() {
  params::Table table;
  params::load_defaults(table);
  return table;
}

bool same(const params::Table& a, const params::Table& b) { return memcmp(&a, &b, sizeof(a)) == 0; }

}  // namespace

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
