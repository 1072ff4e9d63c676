// Damages stored parameter sets and boots: eeprom_faults KIND SEED TRIALS. Prints what came of it, by name.
//
// A set that was never saved may run only when a damaged bank is whole again by chance: magic, layout, length and CRC.
// That is looked up here with a CRC of its own, and counted as a collision.
#include <controllers.h>
#include <fake/fake_hal.h>
#include <parameter_sets.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <string>

#include "counts.h"
#include "definition.h"
#include "must.h"
#include "sets.h"

namespace attack {
namespace {

namespace bank = params::bank;
using hal::fake::board;

using Bank = std::array<std::uint8_t, bank::size>;

std::size_t start(unsigned b) { return b == 0 ? bank::start_a : bank::start_b; }

Bank read_bank(unsigned b) {
  Bank out;
  std::copy_n(board.eeprom.begin() + static_cast<std::ptrdiff_t>(start(b)), bank::size, out.begin());
  return out;
}

void write_bank(unsigned b, const Bank& bytes) {
  std::copy(bytes.begin(), bytes.end(), board.eeprom.begin() + static_cast<std::ptrdiff_t>(start(b)));
}

std::size_t table_bytes(const Bank& bytes) {
  const unsigned layout = bytes[bank::layout_at];
  return layout >= 1 && layout <= params::layout ? params::layout_sizes[layout - 1] : 0;
}

bool whole(const Bank& bytes) {
  const std::size_t table = table_bytes(bytes);
  if (table == 0 || bytes[0] != 0x47 || bytes[1] != 0x57) return false;
  if (bytes[bank::length_at] != table || bytes[bank::length_at + 1] != 0) return false;
  const std::size_t covered = bank::payload_at + table - bank::layout_at;
  const std::uint16_t crc = crc_by_definition(&bytes[bank::layout_at], covered);
  const std::size_t at = bank::payload_at + table;
  return bytes[at] == (crc & 0xFF) && bytes[at + 1] == crc >> 8;
}

// The older layout of which bank b is made: each has one of its own.
std::uint8_t old_layout(unsigned b) { return static_cast<std::uint8_t>(1 + b); }

// A bank as an older firmware has written it.
Bank old_bank(std::uint8_t layout, const params::Table& table, std::uint16_t sequence) {
  const std::size_t size = params::layout_sizes[layout - 1];
  Bank out;
  out.fill(0xFF);
  const auto put_u16 = [&](std::size_t at, unsigned value) {
    out[at] = static_cast<std::uint8_t>(value & 0xFF);
    out[at + 1] = static_cast<std::uint8_t>(value >> 8);
  };
  put_u16(0, bank::magic);
  out[bank::layout_at] = layout;
  put_u16(bank::length_at, static_cast<unsigned>(size));
  put_u16(bank::sequence_at, sequence);
  std::memcpy(&out[bank::payload_at], &table, size);
  const std::size_t covered = bank::payload_at + size - bank::layout_at;
  put_u16(bank::payload_at + size, crc_by_definition(&out[bank::layout_at], covered));
  return out;
}

// What a firmware of today makes of an older set: the parameters that it lacks have their defaults.
params::Table from_old(std::uint8_t layout, const params::Table& table) {
  params::Table out;
  params::load_defaults(out);
  std::memcpy(&out, &table, params::layout_sizes[layout - 1]);
  return out;
}

// A board that has booted: what runs, and whether a loss is told.
struct Boot {
  app::ParameterSets sets;
  app::Controllers controllers;
  bool told = false;

  Boot() {
    board.eeprom_busy_ticks = 0;
    told = !sets.begin(controllers);
  }
  wire::SaveState save() {
    sets.save();
    while (sets.save_state() == wire::SaveState::saving) {
      board.eeprom_busy_ticks = 0;
      sets.work_on_save();
    }
    return sets.save_state();
  }
  void apply(Random& random) {
    const params::Table table = random_set(random);
    for (std::uint16_t i = 0; i < params::count; ++i) {
      std::int32_t value = 0;
      params::get(table, i, value);
      must(sets.stage(i, value) == params::Access::ok, "a random set is within its ranges");
    }
    sets.begin_apply(params::crc(table));
    while (sets.applying()) must(static_cast<int>(sets.work_on_apply(controllers)) < 2, "a random set can be run");
  }
};

// An EEPROM after some saves of different sets.
struct History {
  std::array<std::uint8_t, hal::fake::eeprom_size> cells;
  params::Table newest, older, defaults;
  unsigned newest_bank = 0;  // where the newest set is
  std::array<Bank, 2> banks;
};

History after_saves(Random& random, int saves) {
  board = hal::fake::FakeBoard();
  Boot board_on;
  History out;
  out.defaults = out.newest = out.older = board_on.sets.running();
  for (int i = 0; i < saves; ++i) {
    out.older = out.newest;
    board_on.apply(random);
    out.newest = board_on.sets.running();
    must(board_on.save() == wire::SaveState::saved, "a save ends well");
    out.newest_bank = static_cast<unsigned>(i % 2);
  }
  return out;
}

// Makes the banks old whose bit is set in `old`: bit b is bank b.
void make_old(History& history, unsigned old, std::uint16_t sequence) {
  for (unsigned b = 0; b < 2; ++b) {
    if (!(old >> b & 1)) continue;
    params::Table& table = b == history.newest_bank ? history.newest : history.older;
    table = from_old(old_layout(b), table);
    write_bank(
        b, old_bank(old_layout(b), table, static_cast<std::uint16_t>(sequence - (b == history.newest_bank ? 0 : 1))));
  }
}

void keep(History& history) {
  history.cells = board.eeprom;
  history.banks = {read_bank(0), read_bank(1)};
}

// --- damages

void flip_bits(Random& random, unsigned b, int count) {
  std::set<std::int64_t> at;
  while (static_cast<int>(at.size()) < count) at.insert(between(random, 0, bank::size * 8 - 1));
  for (const std::int64_t bit : at) {
    board.eeprom[start(b) + static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1 << bit % 8);
  }
}

void change_bytes(Random& random, unsigned b, int count) {
  for (; count != 0; --count) {
    const std::size_t at = start(b) + static_cast<std::size_t>(between(random, 0, bank::size - 1));
    board.eeprom[at] ^= static_cast<std::uint8_t>(between(random, 1, 255));
  }
}

// A run of cells that may reach beyond a bank: erased, cleared or random.
void fill_run(Random& random) {
  const std::int64_t from = between(random, 0, bank::start_b + bank::size - 1), count = between(random, 2, 300);
  const std::int64_t how = between(random, 0, 2);
  for (std::int64_t at = from; at < from + count; ++at) {
    const std::int64_t byte = how == 0 ? 0xFF : how == 1 ? 0 : between(random, 0, 255);
    board.eeprom[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(byte);
  }
}

void erase_bank(unsigned b) {
  Bank blank;
  blank.fill(0xFF);
  write_bank(b, blank);
}

void swap_banks(Random& random, bool all) {
  Bank a = read_bank(0), b = read_bank(1);
  const std::int64_t from = all ? 0 : between(random, 0, bank::size - 1);
  const std::int64_t to = all ? bank::size : between(random, from, bank::size);
  std::swap_ranges(a.begin() + from, a.begin() + to, b.begin() + from);
  write_bank(0, a);
  write_bank(1, b);
}

void damage(Random& random, const std::string& kind) {
  const auto b = static_cast<unsigned>(between(random, 0, 1));
  if (kind.rfind("bits", 0) == 0) flip_bits(random, b, std::stoi(kind.substr(4)));
  else if (kind == "bytes" || kind == "old") change_bytes(random, b, static_cast<int>(between(random, 1, 8)));
  else if (kind == "runs") fill_run(random);
  else if (kind == "erased") erase_bank(b);
  else if (kind == "swapped") swap_banks(random, between(random, 0, 9) == 0);
  else must(false, "a damage has a name");
}

// --- what came of it

bool by_collision(const History& history) {
  for (unsigned b = 0; b < 2; ++b) {
    const Bank now = read_bank(b);
    if (whole(now) && now != history.banks[0] && now != history.banks[1]) return true;
  }
  return false;
}

void judge(const History& history, const Boot& boot, Counts& counts) {
  const params::Table& runs = boot.sets.running();
  ++counts["trials"];
  if (same(runs, history.newest)) {
    ++counts["newest runs"];
    return;
  }
  const bool saved = same(runs, history.older) || same(runs, history.defaults);
  if (saved && boot.told) ++counts["lost and told"];
  else if (by_collision(history)) ++counts["collisions"];
  else ++counts[saved ? "untold" : "wrong set"];
}

void do_damage(Random& random, const std::string& kind, std::uint64_t trials, Counts& counts) {
  constexpr std::uint64_t trials_per_history = 200;
  History history;
  for (std::uint64_t i = 0; i < trials; ++i) {
    if (i % trials_per_history == 0) {
      history = after_saves(random, static_cast<int>(between(random, 3, 6)));
      const Bank newest = read_bank(history.newest_bank);
      if (kind == "old") make_old(history, static_cast<unsigned>(between(random, 1, 3)), newest[bank::sequence_at]);
      keep(history);
    }
    board.eeprom = history.cells;
    damage(random, kind);
    judge(history, Boot(), counts);
  }
}

// An EEPROM of an earlier firmware: its sets run whole, and after a save there is a bank of today beside an old one.
void migrate(Random& random, Counts& counts) {
  History history = after_saves(random, static_cast<int>(between(random, 1, 6)));
  const bool one_bank = read_bank(1)[0] == 0xFF;
  const auto old = static_cast<unsigned>(one_bank ? 1 : between(random, 1, 3));
  make_old(history, old, read_bank(history.newest_bank)[bank::sequence_at]);
  ++counts["trials"];
  Boot first;
  bool holds = same(first.sets.running(), history.newest) && !first.told;
  // A table of today that says the same as an old one is saved all the same: the old bank holds less of it.
  const unsigned before = board.eeprom_writes;
  if (between(random, 0, 1)) first.apply(random);
  const params::Table saved = first.sets.running();
  holds = holds && first.save() == wire::SaveState::saved;
  const bool written = board.eeprom_writes != before;
  const Boot second;
  holds = holds && same(second.sets.running(), saved) && !second.told;
  // The newest bank rots: the one before runs, and that is told.
  const unsigned newest = written ? history.newest_bank ^ 1 : history.newest_bank;
  board.eeprom[start(newest) + bank::payload_at] ^= 1;
  const params::Table& left = written ? history.newest : one_bank ? history.defaults : history.older;
  const Boot third;
  holds = holds && same(third.sets.running(), left) && third.told;
  ++counts[holds ? "migrated" : "wrong set"];
}

int main(const std::string& kind, std::uint64_t seed, std::uint64_t trials) {
  Random random(seed);
  Counts counts;
  if (kind == "migration") {
    for (std::uint64_t i = 0; i < trials; ++i) migrate(random, counts);
  } else {
    do_damage(random, kind, trials, counts);
  }
  counts.print();
  return 0;
}

}  // namespace
}  // namespace attack

int main(int count, char** arguments) {
  if (count != 4) return 2;
  return attack::main(arguments[1], std::stoull(arguments[2]), std::stoull(arguments[3]));
}
