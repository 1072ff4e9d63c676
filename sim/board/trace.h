// A running hash over what a program does and when. Two runs behaved alike, to the cycle, if their hashes are equal.
#pragma once

#include <cstdint>

namespace board {

class Trace {
 public:
  enum class Kind : uint8_t { reset, interrupt, uart_byte, eeprom_write, flash_write };

  void add(Kind kind, uint64_t cycle, uint32_t value) {
    mix(cycle);
    mix(static_cast<uint64_t>(kind) << 32 | value);
  }
  uint64_t hash() const { return hash_; }

 private:
  void mix(uint64_t word) {
    hash_ = (hash_ ^ word) * 0x9E3779B97F4A7C15u;
    hash_ ^= hash_ >> 29;
  }
  uint64_t hash_ = 0x6772657977686C65u;
};

}  // namespace board
