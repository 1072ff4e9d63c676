// Start-up, outputs, EEPROM, watchdog and sleep.
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

#include "../hal.h"
#include "internal.h"

namespace hal {
namespace internal {

volatile uint8_t missed_ticks __attribute__((section(".noinit")));

}  // namespace internal

namespace {

// Survive a reset; random after power-on, hence the mark.
volatile uint16_t watchdog_mark __attribute__((section(".noinit")));
uint8_t reset_flags __attribute__((section(".noinit")));   // MCUSR

constexpr uint16_t watchdog_is_on = 0x57a7;
constexpr uint8_t hung_ticks = 40;   // of the 60 that the watchdog waits

}  // namespace

// Runs before main() and before variables are set up: outputs off, reset cause kept, watchdog off (it stays on, at
// its shortest time, after a watchdog reset). No registers are saved: section .init3 is straight-line start-up code.
extern "C" void hal_early_start() __attribute__((naked, used, section(".init3")));
extern "C" void hal_early_start() {
  pins::all_outputs_low();
  uint8_t flags = MCUSR;
  MCUSR = 0;
  wdt_disable();
  // A bootloader that clears MCUSR hides the watchdog; a tick that hung for most of its time betrays it.
  if (flags == 0 && watchdog_mark == watchdog_is_on && internal::missed_ticks >= hung_ticks) flags = 1 << WDRF;
  watchdog_mark = 0;
  internal::missed_ticks = 0;
  reset_flags = flags;
}

Board board_id() { return pins::board; }

// Power-on and brown-out set several flags: the most telling first.
ResetCause reset_cause() {
  if (reset_flags & (1 << WDRF)) return ResetCause::watchdog;
  if (reset_flags & (1 << PORF)) return ResetCause::power_on;
  if (reset_flags & (1 << BORF)) return ResetCause::brown_out;
  if (reset_flags & (1 << EXTRF)) return ResetCause::external;
  return ResetCause::unknown;
}

void begin() {
  cli();
  pins::stop_unused_timers();
  pins::start_pwm();
  internal::start_uart();
  internal::start_tick();
  SMCR = 0;   // idle sleep: timers, ADC and serial port go on
  sei();
}

uint16_t full_duty(uint8_t joint) { return pins::top(joint); }

void set_duty(uint8_t joint, bool positive, uint16_t size) {
  pins::direction(joint, positive);
  pins::compare(joint, size);
}

// The tick interrupt may turn the drivers off at any moment, hence no interrupt between read and write.
void set_drivers(bool on) {
  cli();
  if (on) pins::drivers_on();
  else pins::drivers_off();
  sei();
}

void set_led(bool on) { pins::led(on); }

bool eeprom_busy() { return (EECR & (1 << EEPE)) != 0; }

uint8_t eeprom_read(uint16_t address) {
  EEAR = address;
  EECR = 1 << EERE;
  return EEDR;
}

void eeprom_begin_write(uint16_t address, uint8_t value) {
  EEAR = address;
  EEDR = value;
  cli();   // EEPE must follow EEMPE within four cycles
  EECR = 1 << EEMPE;
  EECR = (1 << EEMPE) | (1 << EEPE);
  sei();
}

void watchdog_start() {
  internal::missed_ticks = 0;
  watchdog_mark = watchdog_is_on;
  wdt_enable(WDTO_60MS);
}

void watchdog_kick() { wdt_reset(); }

// Conversions and sent bytes interrupt the sleep; there is nothing to do for the main loop then.
void idle() {
  for (;;) {
    cli();
    if (tick_pending() || rx_available()) break;
    SMCR = 1 << SE;
    sei();   // takes effect after the next instruction: no interrupt can slip in before the sleep
    sleep_cpu();
    SMCR = 0;
  }
  sei();
}

}  // namespace hal
#endif  // __AVR__
