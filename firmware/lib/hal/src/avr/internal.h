// What the files of hal/avr share among themselves.
#pragma once
#ifdef __AVR__
#include <stdint.h>

namespace hal {
namespace internal {

void start_tick();
void start_uart();

}  // namespace internal
}  // namespace hal
#endif  // __AVR__
