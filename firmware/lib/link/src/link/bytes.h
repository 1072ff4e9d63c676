// Little-endian integers in byte buffers, on every machine. Each is written in halves: avr-gcc makes plain stores of
// them, but would shift a 32-bit value in loops.
#pragma once

#include <stdint.h>

namespace wire {

inline void put_u8(uint8_t* out, uint8_t value) { out[0] = value; }

inline void put_u16(uint8_t* out, uint16_t value) {
  out[0] = static_cast<uint8_t>(value & 0xFF);
  out[1] = static_cast<uint8_t>(value >> 8);
}

inline void put_u32(uint8_t* out, uint32_t value) {
  put_u16(out, static_cast<uint16_t>(value & 0xFFFF));
  put_u16(out + 2, static_cast<uint16_t>(value >> 16));
}

inline uint8_t get_u8(const uint8_t* in) { return in[0]; }

inline uint16_t get_u16(const uint8_t* in) {
  return static_cast<uint16_t>(in[0] | (static_cast<uint16_t>(in[1]) << 8));
}

inline uint32_t get_u32(const uint8_t* in) {
  return static_cast<uint32_t>(get_u16(in)) | (static_cast<uint32_t>(get_u16(in + 2)) << 16);
}

}  // namespace wire
