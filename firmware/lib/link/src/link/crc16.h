// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no reflection; check value over "123456789" is 0x29B1.
#pragma once

#include <stdint.h>

namespace wire {

// Kept as two bytes, because a wide shift is slow on an 8-bit machine. It needs no table.
class Crc16 {
 public:
  constexpr explicit Crc16(uint16_t start = 0xFFFF)
      : high_(static_cast<uint8_t>(start >> 8)), low_(static_cast<uint8_t>(start & 0xFF)) {}

  // Adds a byte. t is the high byte ^ data, folded by four bits. The eight steps of the polynomial then make
  // t << 12 ^ t << 5 ^ t, which is added to the low byte moved up.
  void add(uint8_t byte) {
    uint8_t t = static_cast<uint8_t>(high_ ^ byte);
    t = static_cast<uint8_t>(t ^ (t >> 4));
    const uint8_t t_high = static_cast<uint8_t>(t << 4);
    high_ = static_cast<uint8_t>(low_ ^ t_high ^ (t >> 3));
    low_ = static_cast<uint8_t>(t ^ static_cast<uint8_t>(t_high << 1));
  }

  uint8_t high() const { return high_; }
  uint8_t low() const { return low_; }
  uint16_t value() const { return static_cast<uint16_t>((high_ << 8) | low_); }

 private:
  uint8_t high_, low_;
};

inline uint16_t crc_over(const uint8_t* data, uint8_t size) {
  Crc16 crc;
  for (; size != 0; --size) crc.add(*data++);
  return crc.value();
}

}  // namespace wire
