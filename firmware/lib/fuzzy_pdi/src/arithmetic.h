// The few wide operations of the law: products of at most 32 bits, and a quotient without a division.
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

// Reciprocals of 257..512, 2^17 / (257 + i), less 256. Written out by macros: in C++11, the standard of many Arduino
// cores, no constexpr has a loop.
constexpr uint8_t reciprocal(uint16_t i) { return static_cast<uint8_t>(131072 / (257 + i) - 256); }
#define FUZZY_PDI_RECIPROCALS_4(i) reciprocal(i), reciprocal((i) + 1), reciprocal((i) + 2), reciprocal((i) + 3)
#define FUZZY_PDI_RECIPROCALS_16(i)                                                               \
  FUZZY_PDI_RECIPROCALS_4(i), FUZZY_PDI_RECIPROCALS_4((i) + 4), FUZZY_PDI_RECIPROCALS_4((i) + 8), \
      FUZZY_PDI_RECIPROCALS_4((i) + 12)
#define FUZZY_PDI_RECIPROCALS_64(i)                                                                    \
  FUZZY_PDI_RECIPROCALS_16(i), FUZZY_PDI_RECIPROCALS_16((i) + 16), FUZZY_PDI_RECIPROCALS_16((i) + 32), \
      FUZZY_PDI_RECIPROCALS_16((i) + 48)

// 2^15 * part / whole for part <= whole and 2^16 <= whole < 2^26, by a table and two terms of the geometric series:
// 1 / whole = R / (1 - E) = R (1 + E + E^2 + ...) with E < 2^-7. Less than 0.04 below the quotient before the rounding.
inline uint16_t ratio_q15(uint32_t part, uint32_t whole) {
  static constexpr uint8_t reciprocals[] = {FUZZY_PDI_RECIPROCALS_64(0), FUZZY_PDI_RECIPROCALS_64(64),
                                            FUZZY_PDI_RECIPROCALS_64(128), FUZZY_PDI_RECIPROCALS_64(192)};
  for (; whole >> 24; whole >>= 1) part >>= 1;
  for (; !(whole >> 23); whole <<= 1) part <<= 1;

  const uint32_t r = uint32_t{256} + reciprocals[(whole >> 15) & 255];
  const uint32_t rest = (0xFFFFFFFF - whole * r) >> 9;                // E, 2^-23
  const uint32_t series = rest + (((rest >> 8) * (rest >> 8)) >> 7);  // E + E^2
  const uint32_t first = (part * r) >> 8;                             // 2^-24
  const uint32_t high = first >> 16;
  const uint32_t low = (first >> 8) & 255;
  const uint32_t more = high * (series >> 8) + ((high * (series & 255)) >> 8) + ((low * (series >> 8)) >> 8);
  return static_cast<uint16_t>((((first + 2 * more) >> 8) + 1) >> 1);
}

}  // namespace fuzzy_pdi
