// The CRC as its polynomial defines it, beside the firmware's own.
#pragma once
#include <cstddef>
#include <cstdint>

namespace attack {

// Bit by bit.
inline std::uint16_t crc_by_definition(const std::uint8_t* at, std::size_t count) {
  unsigned crc = 0xFFFF;
  for (; count != 0; --count, ++at) {
    crc ^= static_cast<unsigned>(*at) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1) & 0xFFFF;
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace attack
