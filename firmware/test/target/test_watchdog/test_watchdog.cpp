// A board that hangs is restarted, by the watchdog or by the tick's interrupt, and says so.
// The suite lives through five starts: power-on, a watchdog reset, the tick's interrupt, a plain jump to the reset
// vector, and a watchdog reset whose cause a bootloader clears.
#include <Arduino.h>
#include <hal.h>

#include "../report.h"

namespace {

struct Memory {  // kept over resets
  uint8_t start;
  bool hide_cause;
  hal::ResetCause cause[5];
};
Memory memory __attribute__((section(".noinit")));

// Before the firmware's own start-up code, where a bootloader would be.
extern "C" void play_bootloader() __attribute__((naked, used, section(".init1")));
extern "C" void play_bootloader() {
  __asm__ volatile("clr __zero_reg__");
  if (MCUSR & (1 << PORF)) {
    memory.start = 0;
    memory.hide_cause = false;
  }
  if (memory.hide_cause) MCUSR = 0;
}

void run_healthily() {
  hal::begin();
  hal::watchdog_start();
  for (uint8_t i = 0; i < 100; ++i) {  // longer than the watchdog waits
    while (!hal::tick_pending()) hal::idle();
    finish_tick();
    hal::watchdog_kick();
  }
}

void hang() {
  for (;;) {
  }
}

uint8_t number(hal::ResetCause cause) { return static_cast<uint8_t>(cause); }

}  // namespace

void setup() {
  memory.cause[memory.start] = hal::reset_cause();
  switch (memory.start++) {
    case 0:
      run_healthily();
      cli();
      hang();
      break;
    case 1:
      memory.hide_cause = true;
      run_healthily();
      hang();
      break;
    case 2:
      run_healthily();
      cli();
      __asm__ volatile("jmp 0");
      break;
    case 3:
      run_healthily();
      cli();
      hang();
      break;
    default: break;
  }
  hal::begin();
  EQUAL("power_on_is_told", number(memory.cause[0]), number(hal::ResetCause::power_on));
  EQUAL("a_hang_without_interrupts_is_told", number(memory.cause[1]), number(hal::ResetCause::watchdog));
  EQUAL("one_with_interrupts_needs_no_reset", number(memory.cause[2]), number(hal::ResetCause::watchdog));
  EQUAL("nor_does_a_program_astray", number(memory.cause[3]), number(hal::ResetCause::watchdog));
  EQUAL("what_a_bootloader_clears_is_unknown", number(memory.cause[4]), number(hal::ResetCause::unknown));
  EQUAL("and_the_watchdog_is_off_after_it", WDTCSR & (1 << WDE), 0);
  report::end();
}

void loop() {}
