// What the files of hal/avr share among themselves.
#pragma once
#ifdef __AVR__
#include <stdint.h>

namespace hal {
namespace internal {

void start_tick();
void start_uart();

// Ticks that started while another was unfinished. The count survives a reset: a high one means that the watchdog
// caused the reset. A bootloader that clears MCUSR would hide that.
extern volatile uint8_t missed_ticks;

}  // namespace internal
}  // namespace hal
#endif  // __AVR__
