// The parameter set in EEPROM: two banks, written in turn from the main loop, one byte at a time. A power cut at any
// moment leaves the old or the new set whole.
//
// A bank: magic u16 | layout u8 | length u16 | sequence u16 | packed table | crc u16, the CRC over layout to table. A
// save spoils the first magic byte of the older bank, writes all the rest and reads it back, and puts the magic byte
// right last. A bank with its magic is thus a finished bank, whatever a power cut made of the byte that was being
// written. At boot the bank with the newer sequence wins. Bytes that are already right are not written. A save of a set
// that is already stored writes nothing. Any other save writes each cell of one bank at most once, but the first magic
// byte twice. The banks take turns, so even that byte is written once per save on average: it lasts for 100,000 saves.
//
// A bank of an older layout is read as well: it lacks the last parameters, which get their defaults. The next save
// writes the other bank in today's layout.
//
// A bank that is neither whole nor blank held a set once, or was to hold one: rot, another layout, or a save that a
// power cut ended. Nobody can tell any more whether that set was the newest. So lost() is true then, whatever the other
// bank holds. The same goes for a blank bank beside a whole one, unless that one is of the first save: bank A with
// sequence 1. The next save makes both banks whole again, in turn.
//
// Eeprom has `uint8_t read(uint16_t)`, `void begin_write(uint16_t, uint8_t)` and `bool busy()`. While it is busy,
// neither of the other two is called. It is kept by value: give a reference where it has a state.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "link/crc16.h"
#include "link/schema.h"
#include "params/params.h"

namespace params {

namespace bank {
constexpr uint16_t magic = 0x5747;  // "GW"
constexpr uint8_t layout_at = 2;
constexpr uint8_t length_at = 3;
constexpr uint8_t sequence_at = 5;
constexpr uint8_t payload_at = 7;
constexpr uint8_t crc_at = payload_at + table_size;
constexpr uint8_t size = crc_at + 2;
static_assert(payload_at + table_size + 2 <= 255, "positions within a bank are bytes");
// Address 0 is not used: a brown-out is most likely to spoil that cell.
constexpr uint16_t start_a = 16;
constexpr uint16_t start_b = start_a + 256;
}  // namespace bank

template <class Eeprom>
class Store {
 public:
  constexpr Store() : eeprom_() {}
  explicit Store(Eeprom eeprom) : eeprom_(eeprom) {}

  // At boot: loads the newest bank that is whole and in range, or else the defaults. Waits for a write that a reset
  // left behind.
  wire::ParamSource load(Table& table);

  // True while a bank that held a set does not any more: what ran before this boot may have been another set.
  bool lost() const { return spoilt_ != 0; }

  // Starts to save. `table` must stay as it is until state() is no longer saving. Does nothing while saving.
  void save(const Table& table);

  // Does one step, which writes at most one byte. Call it again and again from the main loop.
  void poll();

  wire::SaveState state() const { return state_; }

  // Of the newest bank, or of the one that is being written: it counts the saves.
  uint16_t sequence() const { return sequence_; }

 private:
  enum class Phase : uint8_t { idle, compare, spoil, spoiled, write, verify, seal, sealed };

  static constexpr uint8_t no_bank = 2;
  static uint16_t start(uint8_t b) { return b == 0 ? bank::start_a : bank::start_b; }

  bool whole(uint8_t b, uint16_t& sequence);
  bool blank(uint8_t b);
  bool never_used(uint8_t b, bool other_is_good, uint16_t other_sequence);
  uint8_t table_bytes(uint8_t b);
  bool fetch(uint8_t b, Table& table);
  uint16_t read_u16(uint16_t at) { return static_cast<uint16_t>(eeprom_.read(at) | (eeprom_.read(at + 1) << 8)); }

  uint8_t image(uint8_t position);
  void walk(Phase phase, uint8_t from);
  bool step(uint8_t b, bool write);
  void retarget();
  void stored();
  void finish(wire::SaveState state);

  Eeprom eeprom_;
  const Table* table_ = nullptr;
  uint16_t sequence_ = 0;  // the newest in EEPROM, or the one that is being written
  wire::Crc16 crc_{0};     // over the positions walked so far
  uint8_t position_ = 0;
  uint8_t current_ = 0;  // the bank that a boot would load
  uint8_t target_ = 0;
  uint8_t spoilt_ = 0;  // bit b: bank b held a set, or was to, and does not
  Phase phase_ = Phase::idle;
  wire::SaveState state_ = wire::SaveState::idle;
};

template <class Eeprom>
bool Store<Eeprom>::whole(uint8_t b, uint16_t& sequence) {
  const uint16_t at = start(b);
  const uint8_t bytes = table_bytes(b);
  if (read_u16(at) != bank::magic || bytes == 0 || read_u16(at + bank::length_at) != bytes) return false;
  const auto crc_at = static_cast<uint8_t>(bank::payload_at + bytes);
  wire::Crc16 crc;
  for (uint8_t i = bank::layout_at; i < crc_at; ++i) crc.add(eeprom_.read(static_cast<uint16_t>(at + i)));
  if (crc.value() != read_u16(static_cast<uint16_t>(at + crc_at))) return false;
  sequence = read_u16(at + bank::sequence_at);
  return true;
}

// How much of the table a bank of its layout holds; 0 for a layout that is not known.
template <class Eeprom>
uint8_t Store<Eeprom>::table_bytes(uint8_t b) {
  const uint8_t found = eeprom_.read(start(b) + bank::layout_at);
  return found >= 1 && found <= layout ? layout_sizes[found - 1] : 0;
}

template <class Eeprom>
bool Store<Eeprom>::blank(uint8_t b) {
  for (uint8_t i = 0; i < bank::size; ++i) {
    if (eeprom_.read(static_cast<uint16_t>(start(b) + i)) != 0xFF) return false;
  }
  return true;
}

// The first save goes to bank A with sequence 1, the second one to bank B.
template <class Eeprom>
bool Store<Eeprom>::never_used(uint8_t b, bool other_is_good, uint16_t other_sequence) {
  return blank(b) && (!other_is_good || (b == 1 && other_sequence == 1));
}

template <class Eeprom>
bool Store<Eeprom>::fetch(uint8_t b, Table& table) {
  uint8_t* out = reinterpret_cast<uint8_t*>(&table);
  const uint16_t at = start(b) + bank::payload_at;
  load_defaults(table);
  for (uint8_t i = table_bytes(b); i-- > 0;) out[i] = eeprom_.read(static_cast<uint16_t>(at + i));
  return first_invalid(table) == none;
}

template <class Eeprom>
wire::ParamSource Store<Eeprom>::load(Table& table) {
  while (eeprom_.busy()) {
  }
  uint16_t sequences[2] = {0, 0};
  const bool good[2] = {whole(0, sequences[0]), whole(1, sequences[1])};
  // Sequence numbers wrap: b is newer when it is less than half the circle ahead.
  const bool b_newer = good[1] && (!good[0] || static_cast<uint16_t>(sequences[1] - sequences[0]) < 0x8000);
  const uint8_t newest = b_newer ? 1 : 0;
  sequence_ = sequences[newest];
  current_ = no_bank;
  spoilt_ = 0;
  for (uint8_t i = 0; i < 2; ++i) {
    const uint8_t b = static_cast<uint8_t>(newest ^ i);
    if (good[b] && current_ != no_bank) continue;  // the older set
    if (good[b] && fetch(b, table)) {
      current_ = b;
    } else if (good[b] || !never_used(b, good[b ^ 1], sequences[b ^ 1])) {
      spoilt_ = static_cast<uint8_t>(spoilt_ | (1 << b));
    }
  }
  if (current_ == no_bank) {
    load_defaults(table);
    return wire::ParamSource::defaults;
  }
  return current_ == 0 ? wire::ParamSource::bank_a : wire::ParamSource::bank_b;
}

template <class Eeprom>
void Store<Eeprom>::save(const Table& table) {
  if (state_ == wire::SaveState::saving) return;
  table_ = &table;
  state_ = wire::SaveState::saving;
  if (current_ == no_bank) {
    retarget();
  } else {
    target_ = current_;
    walk(Phase::compare, 0);
  }
}

// Chooses the bank that may be overwritten, and the next sequence number.
template <class Eeprom>
void Store<Eeprom>::retarget() {
  target_ = current_ == 0 ? 1 : 0;
  ++sequence_;
  phase_ = Phase::spoil;
}

// The target holds the set. The other bank is next if it has to be mended.
template <class Eeprom>
void Store<Eeprom>::stored() {
  current_ = target_;
  spoilt_ = static_cast<uint8_t>(spoilt_ & ~(1 << target_));
  if (spoilt_ != 0) {
    retarget();
  } else {
    finish(wire::SaveState::saved);
  }
}

template <class Eeprom>
void Store<Eeprom>::walk(Phase phase, uint8_t from) {
  phase_ = phase;
  position_ = from;
  crc_ = wire::Crc16();
}

template <class Eeprom>
void Store<Eeprom>::finish(wire::SaveState state) {
  phase_ = Phase::idle;
  state_ = state;
}

// The byte that belongs at a position. Ask for positions from layout_at on in their order, because of the CRC.
template <class Eeprom>
uint8_t Store<Eeprom>::image(uint8_t position) {
  uint8_t byte = 0;
  switch (position) {
    case 0: return bank::magic & 0xFF;
    case 1: return bank::magic >> 8;
    case bank::layout_at: byte = layout; break;
    case bank::length_at: byte = table_size & 0xFF; break;
    case bank::length_at + 1: byte = table_size >> 8; break;
    case bank::sequence_at: byte = static_cast<uint8_t>(sequence_ & 0xFF); break;
    case bank::sequence_at + 1: byte = static_cast<uint8_t>(sequence_ >> 8); break;
    case bank::crc_at: return crc_.low();
    case bank::crc_at + 1: return crc_.high();
    default: byte = reinterpret_cast<const uint8_t*>(table_)[position - bank::payload_at];
  }
  crc_.add(byte);
  return byte;
}

// One position of a walk. True when the EEPROM held the right byte; otherwise `write` says whether it is written.
template <class Eeprom>
bool Store<Eeprom>::step(uint8_t b, bool write) {
  const uint8_t byte = image(position_);
  const uint16_t at = static_cast<uint16_t>(start(b) + position_);
  ++position_;
  if (eeprom_.read(at) == byte) return true;
  if (write) eeprom_.begin_write(at, byte);
  return false;
}

template <class Eeprom>
void Store<Eeprom>::poll() {
  if (phase_ == Phase::idle || eeprom_.busy()) return;
  const uint16_t first = start(target_);
  const uint8_t mark = image(0);
  switch (phase_) {
    case Phase::compare:
      if (!step(target_, false)) {
        retarget();
      } else if (position_ == bank::size) {
        stored();
      }
      break;
    case Phase::spoil:
      spoilt_ = static_cast<uint8_t>(spoilt_ | (1 << target_));
      if (eeprom_.read(first) == mark) eeprom_.begin_write(first, static_cast<uint8_t>(~mark));
      phase_ = Phase::spoiled;
      break;
    case Phase::spoiled:
      if (eeprom_.read(first) == mark) {
        finish(wire::SaveState::failed);
      } else {
        walk(Phase::write, 1);
      }
      break;
    case Phase::write:
      step(target_, true);
      if (position_ == bank::size) walk(Phase::verify, 1);
      break;
    case Phase::verify:
      if (!step(target_, false)) {
        finish(wire::SaveState::failed);
      } else if (position_ == bank::size) {
        phase_ = Phase::seal;
      }
      break;
    case Phase::seal:
      eeprom_.begin_write(first, mark);
      phase_ = Phase::sealed;
      break;
    case Phase::sealed:
      if (eeprom_.read(first) == mark) {
        stored();
      } else {
        finish(wire::SaveState::failed);
      }
      break;
    case Phase::idle: break;
  }
}

}  // namespace params
