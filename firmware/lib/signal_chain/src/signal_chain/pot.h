// From a potentiometer's conversions to its angle: low-pass and calibration.
#pragma once
#include <stdint.h>

namespace signal_chain {

// A low-pass smooths a potentiometer's readings: each tick gives it the new value
//   filtered * keep / 2^8, rounded, + sum * gain
// where `filtered` is the value before, the 10-bit count x 64, and `sum` is of four 10-bit conversions. The first
// product is the share of the old value. It does not need the sum, so it is worked out before the tick.
struct LowPass {
  uint8_t keep, gain;
};

// The new sum has a weight of 2^-shift, shift 0..4; with 0 nothing is left of the old value.
constexpr LowPass low_pass(uint8_t shift) {
  return {static_cast<uint8_t>(256 - (256 >> shift)), static_cast<uint8_t>(16 >> shift)};
}

inline uint16_t old_share(uint16_t filtered, LowPass weights) {
  if (weights.keep == 128) return static_cast<uint16_t>(filtered - (filtered >> 1));  // the default, and no product
  return static_cast<uint16_t>((static_cast<uint32_t>(filtered) * weights.keep + 128) >> 8);
}
inline uint16_t add_sum(uint16_t old_share, uint16_t sum, LowPass weights) {
  return static_cast<uint16_t>(old_share + static_cast<uint32_t>(sum) * weights.gain);
}
inline uint16_t filter(uint16_t filtered, uint16_t sum, LowPass weights) {
  return add_sum(old_share(filtered, weights), sum, weights);
}

// angle = (filtered * scale + offset) / 2^15 in q12 rad. The sum has 31 bits at most, the angle 16.
struct Pot {
  uint16_t filtered;
  int16_t scale;
  int32_t offset;
};

// What makes the angle ((count14 - zero) * scale + 4096) >> 13, where count14 = filtered / 4 is not rounded.
constexpr int32_t offset(uint16_t zero, int16_t scale) { return 0x4000 - static_cast<int32_t>(zero) * 4 * scale; }

// The sum is doubled and its upper half taken: a shift by 15 takes an 8-bit machine long.
inline int16_t angle(const Pot& pot) {
  const int32_t sum = static_cast<int32_t>(pot.filtered) * pot.scale + pot.offset;
  return static_cast<int16_t>((static_cast<uint32_t>(sum) << 1) >> 16);
}

inline int16_t clamp(int16_t value, int16_t least, int16_t most) {
  return value < least ? least : value > most ? most : value;
}

// |a - b|
inline uint16_t distance(int16_t a, int16_t b) { return static_cast<uint16_t>(a > b ? a - b : b - a); }

}  // namespace signal_chain
