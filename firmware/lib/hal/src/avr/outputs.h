// The duties' registers, inlined into the tick. Included by hal.h.
#pragma once
#ifdef __AVR__
#include "pins.h"

namespace hal {

template <uint8_t joint>
inline void set_duty(bool positive, uint16_t size) {
  pins::direction(joint, positive);
  pins::compare(joint, size);
}

}  // namespace hal
#endif  // __AVR__
