// Work with the parameter table: access by flat index, ranges, defaults, CRC, and the rules between parameters.
#pragma once

#include <stdint.h>

#include "params/table.h"

namespace params {

enum class Access : uint8_t { ok, bad_index, out_of_range };

constexpr uint8_t none = 0xFF;  // no index

// Reads one parameter. Does not touch `value` when there is no such index.
Access get(const Table& table, uint16_t index, int32_t& value);

// Changes one parameter, if the value is within its range.
Access set(Table& table, uint16_t index, int32_t value);

void load_defaults(Table& table);

// Gives a joint the controller of the defaults, with no gain and no voltage above its own.
void make_safe(Table& table, uint8_t joint);

// CRC over the packed table, as the host computes it. About 4,000 cycles: not for the tick.
uint16_t crc(const Table& table);

// Flat index of the first parameter that contradicts another one (limit_min not below limit_max), or none. This check
// is enough for a table that was filled through set() alone. Whether the fuzzy controllers can run the set, their owner
// decides.
uint8_t first_inconsistent(const Table& table);

// Checks the same and every range: for a table that came from storage.
uint8_t first_invalid(const Table& table);

// The set that runs and the set that is being prepared. All changes go to `staged`; apply() makes them effective at
// once. The main loop calls apply() between two ticks.
class Sets {
 public:
  // Starts both from one table.
  void begin(const Table& table);

  const Table& running() const { return running_; }
  const Table& staged() const { return staged_; }
  Table& staged() { return staged_; }  // to be filled as a whole, from storage
  uint16_t running_crc() const { return running_crc_; }

  Access stage(uint16_t index, int32_t value) { return set(staged_, index, value); }
  void stage_defaults() { load_defaults(staged_); }
  void apply();

 private:
  Table running_ = {};
  Table staged_ = {};
  uint16_t running_crc_ = 0;
};

}  // namespace params
