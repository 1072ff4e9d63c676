// What is inlined into the tick. Included by hal.h.
#pragma once
#ifdef __AVR__
#include "pins.h"

namespace hal {

template <uint8_t joint>
inline void set_duty(bool positive, uint16_t size) {
  pins::direction(joint, positive);
  pins::compare(joint, size);
}

namespace internal {

extern volatile uint8_t elapsed;   // ticks since tick_begin()

uint16_t age_with(uint8_t ticks, uint8_t count);   // count: 4 us

}  // namespace internal

inline uint16_t tick_age_us() {
  uint8_t ticks, count;
  do {
    ticks = internal::elapsed;
    count = TCNT0;
  } while (ticks != internal::elapsed);   // a tick in between: read again
  return ticks == 0 ? static_cast<uint16_t>(count * 4u) : internal::age_with(ticks, count);
}

}  // namespace hal
#endif  // __AVR__
