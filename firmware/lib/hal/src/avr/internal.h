// What the files of hal/avr share among themselves.
#pragma once
#ifdef __AVR__
#include <stdint.h>

namespace hal {
namespace internal {

void start_tick();
void start_uart();

// Ticks that started while one was unfinished. Kept over a reset: many of them mean that the watchdog did it, which
// a bootloader hides by clearing MCUSR.
extern volatile uint8_t missed_ticks;

}  // namespace internal
}  // namespace hal
#endif  // __AVR__
