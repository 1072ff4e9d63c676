// The parts of the hardware's interface that are inlined: into the tick, and around it. hal.h includes this.
#pragma once
#ifdef __AVR__
#include "pins.h"

// The rings and sums of interrupts.S begin at a multiple of 32. They are the only ones in section .bss, which comes
// first in RAM, so that no byte is lost to that. All other variables go behind them: those that have this mark.
#define BEHIND_RINGS __attribute__((section(".bss.behind_rings")))

// The tick saves no registers (OS_task): the controllers need nearly all of them, and main() keeps nothing in them.
extern "C" __attribute__((OS_task, noinline, used, externally_visible)) void firmware_tick();

namespace hal {

inline __attribute__((always_inline)) void run_tick() {
  __asm__ volatile(
      "push r28\n\t"
      "push r29\n\t"
      "%~call firmware_tick\n\t"
      "pop r29\n\t"
      "pop r28"
      :
      :
      : "r2", "r3", "r4", "r5", "r6", "r7", "r8", "r9", "r10", "r11", "r12", "r13", "r14", "r15", "r16", "r17", "r18",
        "r19", "r20", "r21", "r22", "r23", "r24", "r25", "r26", "r27", "r30", "r31", "memory");
}

namespace internal {

extern Driver driver;

// Kept out of the tick's usual path.
void set_two_pwm(uint8_t joint, bool positive, uint16_t size);

}  // namespace internal

template <uint8_t joint>
inline void set_duty(bool positive, uint16_t size) {
  if (__builtin_expect(pins::has_two_pwm(internal::driver), false)) {
    return internal::set_two_pwm(joint, positive, size);
  }
  pins::direction(joint, positive);
  pins::compare(joint, size);
}

// The probe is sampled 48 to 80 cycles after its start, and the tick does 35 cycles of other work until here.
inline void end_pull_ups() {
  __builtin_avr_delay_cycles(52);
  pins::pull_up_pots(0);
}
inline bool estop_low() { return pins::estop_low(); }
inline bool clutch_low() { return pins::clutch_low(); }

namespace internal {

extern volatile uint8_t elapsed;  // ticks since tick_begin()

uint16_t age_with(uint8_t ticks, uint8_t count);  // count: 4 us

}  // namespace internal

inline uint16_t tick_age_us() {
  uint8_t ticks, count;
  do {
    ticks = internal::elapsed;
    count = TCNT0;
  } while (ticks != internal::elapsed);  // a tick in between: read again
  return ticks == 0 ? static_cast<uint16_t>(count * 4u) : internal::age_with(ticks, count);
}

}  // namespace hal
#endif  // __AVR__
