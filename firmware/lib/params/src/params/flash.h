// Constants in flash: PROGMEM of avr-libc on the boards, ordinary memory elsewhere.
#pragma once

#if defined(__AVR__)
#include <avr/pgmspace.h>
#else
#include <string.h>
#define PROGMEM
#endif

namespace params {

template <class T>
inline void read_flash(T& out, const T& in_flash) {
#if defined(__AVR__)
  memcpy_P(&out, &in_flash, sizeof(T));
#else
  memcpy(&out, &in_flash, sizeof(T));
#endif
}

}  // namespace params
