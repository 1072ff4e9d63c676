// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no reflection; check value over "123456789" is 0x29B1.
#pragma once

#include <stdint.h>

namespace wire {

constexpr uint16_t crc_start = 0xFFFF;

// One byte more. With t = high byte ^ data, folded by four bits, the eight polynomial steps come to t << 12 ^ t << 5 ^ t;
// written in bytes because an 8-bit machine has no wide shifts, and needs no table this way.
inline uint16_t crc_add(uint16_t crc, uint8_t byte) {
  uint8_t t = static_cast<uint8_t>((crc >> 8) ^ byte);
  t = static_cast<uint8_t>(t ^ (t >> 4));
  const uint8_t t_high = static_cast<uint8_t>(t << 4);
  const uint8_t high = static_cast<uint8_t>((crc & 0xFF) ^ t_high ^ (t >> 3));
  const uint8_t low = static_cast<uint8_t>(t ^ static_cast<uint8_t>(t_high << 1));
  return static_cast<uint16_t>((high << 8) | low);
}

inline uint16_t crc_over(const uint8_t *data, uint8_t size, uint16_t crc = crc_start) {
  for (uint8_t i = 0; i < size; ++i) crc = crc_add(crc, data[i]);
  return crc;
}

}  // namespace wire
