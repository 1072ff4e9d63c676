// Start-up, outputs, EEPROM, watchdog and sleep.
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

#include "../hal.h"
#include "internal.h"

namespace hal {
namespace {

uint8_t reset_flags __attribute__((section(".noinit")));  // MCUSR; set before variables are

}  // namespace

// Runs before main() and before variables are set up. Turns outputs off, keeps the reset cause, and turns the watchdog
// off, which a watchdog reset leaves on at its shortest time. It saves no registers: section .init3 is straight-line
// start-up code.
extern "C" void hal_early_start() __attribute__((naked, used, section(".init3")));
extern "C" void hal_early_start() {
  pins::all_outputs_low();
  uint8_t flags = MCUSR;
  MCUSR = 0;
  wdt_disable();
  // A reset turns the tick's interrupts off. Where they are on, the program has come here by itself: after a hang
  // (tick.cpp, or the function below), or astray.
  if (TIMSK0) flags = 1 << WDRF;
  reset_flags = flags;
}

// The Mega's bootloader clears MCUSR, so a reset by the watchdog would look like any other. But after that one alone it
// does not wait for a host: it means to call address 0, and calls 0x20000, because its EICALL takes the upper bits from
// EIND. The linker puts this function there (platformio.ini).
extern "C" void hal_after_watchdog() __attribute__((naked, used, section(".after_watchdog")));
extern "C" void hal_after_watchdog() {
  cli();
  TIMSK0 = 1 << OCIE0A;
  __asm__ volatile("jmp 0");
}

Board board_id() { return pins::board; }

// Power-on and brown-out set several flags, so the order of these questions matters.
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
  SMCR = 0;  // idle sleep: timers, ADC and serial port go on
  sei();
}

namespace internal {

BEHIND_RINGS Driver driver = Driver::pwm_direction;

__attribute__((noinline)) void set_two_pwm(uint8_t joint, bool positive, uint16_t size) {
  const bool high = driver == Driver::two_pwm_high;
  const uint16_t driven = high ? pins::top(joint) : size;
  const uint16_t other = high ? static_cast<uint16_t>(pins::top(joint) - size) : 0;
  if (positive) pins::compare_pair(joint, driven, other);
  else pins::compare_pair(joint, other, driven);
}

}  // namespace internal

bool has_driver(Driver driver) { return driver <= pins::last_driver; }

void choose_driver(Driver driver) {
  internal::driver = driver;
  pins::wire(driver);
}

uint16_t full_duty(uint8_t joint) { return pins::top(joint); }

void set_duty(uint8_t joint, bool positive, uint16_t size) {
  if (pins::has_two_pwm(internal::driver)) return internal::set_two_pwm(joint, positive, size);
  pins::direction(joint, positive);
  pins::compare(joint, size);
}

// The tick's interrupt may turn the drivers off at any moment, so there must be none between read and write.
void set_drivers(bool on) {
  cli();
  if (on) pins::drivers_on(internal::driver);
  else pins::drivers_off();
  sei();
}

void set_led(bool on) { pins::led(on); }

bool eeprom_busy() {
  uint8_t control = EECR;
#if __GNUC__ == 14  // ends in an error of its own (avr_out_extr_not) where it may read and negate the bit in one
  __asm__("" : "+r"(control));
#endif
  return (control & (1 << EEPE)) != 0;
}

uint8_t eeprom_read(uint16_t address) {
  EEAR = address;
  EECR = 1 << EERE;
  return EEDR;
}

void eeprom_begin_write(uint16_t address, uint8_t value) {
  EEAR = address;
  EEDR = value;
  cli();  // EEPE must follow EEMPE within four cycles
  EECR = 1 << EEMPE;
  EECR = (1 << EEMPE) | (1 << EEPE);
  sei();
}

void watchdog_start() { wdt_enable(WDTO_15MS); }

void watchdog_kick() { wdt_reset(); }

// Conversions and sent bytes end the sleep too, but then the main loop has nothing to do.
void idle() {
  for (;;) {
    cli();
    if (tick_pending() || rx_available()) break;
    SMCR = 1 << SE;
    sei();  // takes effect after the next instruction: no interrupt can slip in before the sleep
    sleep_cpu();
    SMCR = 0;
  }
  sei();
}

}  // namespace hal
#endif  // __AVR__
