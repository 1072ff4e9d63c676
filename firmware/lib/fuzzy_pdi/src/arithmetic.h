// The few wide operations the law is made of, without a software multiply or divide.
#pragma once

#include <stdint.h>

namespace fuzzy_pdi {

// size * factor, 48 bits: whole * 2^16 + fraction.
struct Product {
  uint32_t whole;
  uint16_t fraction;
};

inline Product multiply(uint16_t size, uint32_t factor) {
  const uint32_t low = static_cast<uint32_t>(size) * static_cast<uint16_t>(factor);
  const uint32_t high = static_cast<uint32_t>(size) * static_cast<uint16_t>(factor >> 16);
  return {high + (low >> 16), static_cast<uint16_t>(low)};
}

// round(2^15 * part / whole), half up, for part <= whole < 2^24 and whole > 0.
inline uint16_t ratio_q15(uint32_t part, uint32_t whole) {
  uint32_t quotient = 0;
  for (uint8_t bit = 0; bit < 17; ++bit) {
    quotient <<= 1;
    if (part >= whole) {
      part -= whole;
      quotient |= 1;
    }
    part <<= 1;
  }
  return static_cast<uint16_t>((quotient + 1) >> 1);
}

}  // namespace fuzzy_pdi
