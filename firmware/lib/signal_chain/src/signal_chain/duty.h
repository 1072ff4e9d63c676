// From voltages to duties: the voltage limit, and division by the supply as a product.
#pragma once
#include <stdint.h>

#include "signal_chain/upper_product.h"

namespace signal_chain {

// (supply * share) >> 15. The supply is below 32,768 mV; a share of 32768 is all of it.
inline uint16_t limit_mv(uint16_t supply_mv, uint16_t share_q15) {
  return upper_product(static_cast<uint16_t>(supply_mv * 2), share_q15);
}

// 2^18 * full duty / supply, rounded: below 2^16 for duties up to 749 and supplies from 3 V on. Divides: not for the
// tick.
inline uint16_t duty_scale(uint16_t full_duty, uint16_t supply_mv) {
  return static_cast<uint16_t>(((static_cast<uint32_t>(full_duty) << 18) + supply_mv / 2u) / supply_mv);
}

// size * full duty / supply = (size * scale + 2^17) >> 18: the duty nearest to a voltage, in the PWM's own steps. The
// voltage is at most the supply.
inline uint16_t duty(uint16_t size_mv, uint16_t scale) {
  return static_cast<uint16_t>(upper_product(size_mv, scale) + 2u) >> 2;
}

}  // namespace signal_chain
