// The parameter table at work: access by flat index, ranges, defaults, CRC, and what one value demands of another.
#pragma once

#include <stdint.h>

#include "params/table.h"

namespace params {

enum class Access : uint8_t { ok, bad_index, out_of_range };

constexpr uint8_t none = 0xFF;  // no index

// The value of one parameter; leaves `value` alone when there is no such index.
Access get(const Table &table, uint16_t index, int32_t &value);

// Changes one parameter, if the value is within its range.
Access set(Table &table, uint16_t index, int32_t value);

void load_defaults(Table &table);

// CRC over the packed table, as the host computes it. About 4,000 cycles: not for the tick.
uint16_t crc(const Table &table);

// Flat index of the first parameter that contradicts another one (limit_min not below limit_max), or none. Enough for a
// table that was filled through set() alone. Whether the fuzzy controllers can run the set is for their owner to say.
uint8_t first_inconsistent(const Table &table);

// The same, and every range: for a table that came from storage.
uint8_t first_invalid(const Table &table);

// What runs and what is being prepared. All changes go to `staged`; apply() makes them effective at once. Both are
// used from the main loop only, so between two ticks is where the loop calls apply().
class Sets {
 public:
  // Starts both from one table.
  void begin(const Table &table);

  const Table &running() const { return running_; }
  const Table &staged() const { return staged_; }
  Table &staged() { return staged_; }  // to be filled as a whole, from storage
  uint16_t running_crc() const { return running_crc_; }

  Access stage(uint16_t index, int32_t value) { return set(staged_, index, value); }
  void stage_defaults() { load_defaults(staged_); }
  void apply();

 private:
  Table running_;
  Table staged_;
  uint16_t running_crc_ = 0;
};

}  // namespace params
