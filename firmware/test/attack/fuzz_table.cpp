// libFuzzer over the parameter table: any bytes as a table, as changes to one, and as an EEPROM.
#include <controllers.h>
#include <fake/fake_hal.h>
#include <parameter_sets.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "definition.h"
#include "law.h"
#include "must.h"
#include "sets.h"

namespace attack {
namespace {

constexpr std::uint16_t limit_mv = 15000;

// A value of 2^31 and more reads as a negative one.
bool in_range(std::uint16_t index, std::int32_t value) {
  const params::Field& field = field_of(index);
  return value >= field.minimum && value <= field.maximum && (value != 0 || !field.nonzero);
}

bool is_valid(const params::Table& table) {
  for (std::uint16_t i = 0; i < params::count; ++i) {
    std::int32_t value = 0;
    must(params::get(table, i, value) == params::Access::ok, "every index can be read");
    if (!in_range(i, value)) return false;
  }
  for (const params::JointParameters& joint : table.joint) {
    if (joint.limit_min >= joint.limit_max) return false;
  }
  return true;
}

void judge_table(const params::Table& table) {
  must((params::first_invalid(table) == params::none) == is_valid(table), "a valid set is one whose values are");
  if (params::first_invalid(table) == params::none) {
    must(params::first_inconsistent(table) == params::none, "a valid set does not contradict itself");
  }
  app::Controllers controllers;
  for (std::uint8_t i = 0; i < hal::joint_count; ++i) {
    if (controllers.take(table, i) != fuzzy_pdi::Refusal::none) continue;
    for (const int error : {0, 1, -1, 32767, -32767, 4096}) {
      const app::MotorVoltage out = controllers.step(i, static_cast<std::int16_t>(error), limit_mv);
      must(out.size_mv <= limit_mv, "no voltage above its limit");
    }
  }
}

// Six bytes for each change: an index and a value.
void judge_changes(params::Table table, const std::uint8_t* data, std::size_t size) {
  for (; size >= 6; data += 6, size -= 6) {
    const std::uint16_t index = wire::get_u16(data);
    const auto value = static_cast<std::int32_t>(wire::get_u32(data + 2));
    const params::Table before = table;
    const params::Access access = params::set(table, index, value);
    if (index >= params::count) {
      must(access == params::Access::bad_index, "there is no such index");
    } else {
      must((access == params::Access::ok) == in_range(index, value), "a value within its range is taken");
    }
    std::int32_t now = 0, was = 0;
    for (std::uint16_t i = 0; i < params::count; ++i) {
      params::get(table, i, now);
      params::get(before, i, was);
      must(i == index && access == params::Access::ok ? now == value : now == was, "one value changes, or none");
    }
  }
}

// Makes a bank whole around the bytes that it holds, so that they are looked at.
void seal(std::uint16_t start, std::uint8_t layout) {
  namespace bank = params::bank;
  std::uint8_t* at = &hal::fake::board.eeprom[start];
  const std::uint8_t bytes = params::layout_sizes[layout - 1];
  wire::put_u16(at, bank::magic);
  at[bank::layout_at] = layout;
  wire::put_u16(at + bank::length_at, bytes);
  const std::size_t covered = bank::payload_at + std::size_t{bytes} - bank::layout_at;
  wire::put_u16(at + bank::payload_at + bytes, crc_by_definition(at + bank::layout_at, covered));
}

void judge_eeprom(const std::uint8_t* data, std::size_t size) {
  using hal::fake::board;
  board = hal::fake::FakeBoard();
  std::copy_n(data, std::min(size, board.eeprom.size()), board.eeprom.begin() + params::bank::start_a);
  if (size % 4 != 0) seal(params::bank::start_a, static_cast<std::uint8_t>(size % 4));
  if (size % 8 >= 4) seal(params::bank::start_b, size % 8 == 5 ? std::uint8_t{1} : params::layout);
  app::ParameterSets sets;
  app::Controllers controllers;
  sets.begin(controllers);
  must(params::first_invalid(sets.running()) == params::none && can_run(sets.running()),
       "whatever the EEPROM holds, a set runs that can be run");
}

}  // namespace
}  // namespace attack

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  params::Table table;
  params::load_defaults(table);
  std::memcpy(&table, data, std::min(size, sizeof table));
  attack::judge_table(table);
  params::load_defaults(table);
  attack::judge_changes(table, data, size);
  attack::judge_eeprom(data, std::min<std::size_t>(size, 512));
  return 0;
}
