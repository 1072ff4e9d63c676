// The 1 kHz tick by timer 0, and the start of the chain of 32 ADC conversions (interrupts.S goes on with it).
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>
#include <string.h>

#include "../hal.h"
#include "internal.h"
#include "pins.h"
#include "shared_state.h"

namespace hal {
namespace {

static_assert(CONVERSIONS == pot_count * conversions_per_pot, "each pot in turn, the same number of times");

constexpr uint8_t channel(uint8_t n) { return static_cast<uint8_t>((1 << REFS0) | (n & 7)); }   // reference AVcc

volatile uint8_t filling = 0;   // of the two sets of sums; the interrupt adds there, the other one is the main loop's
volatile uint8_t full = 0;      // the main loop's one holds sums that it has not read
volatile uint8_t running = 0;   // a tick has started and tick_end() has not been called
volatile uint8_t elapsed = 0;
volatile uint8_t late = 0;

}  // namespace

// The first conversion is started before anything else: its moment does not depend on the work below.
ISR(TIMER0_COMPA_vect) {
  const bool restart = CONVERSION == CONVERSIONS && !full;
  if (restart) {
    ADCSRA = ADC_CHAIN;   // channel 0 was chosen by the last interrupt of the chain before
    CONVERSION = 0;
    const uint8_t next = filling ^ 1;
    filling = next;
    SUM_POSITION = static_cast<uint8_t>(reinterpret_cast<uint16_t>(hal_sums[next]));
    full = 1;
  } else {
    late = 1;
  }
  elapsed = static_cast<uint8_t>(elapsed + 1);
  if (running) {
    pins::drivers_off();
    late = 1;
    const uint8_t missed = internal::missed_ticks;
    if (missed != 255) internal::missed_ticks = static_cast<uint8_t>(missed + 1);
  }
  running = 1;
  // The channel of conversion 1: allowed one ADC clock (32 cycles) after the start of conversion 0.
  if (restart) {
    __builtin_avr_delay_cycles(12);
    ADMUX = channel(1);
  }
}

namespace internal {

void start_tick() {
  TIMSK0 = 0;   // the framework's millis() interrupt
  TCCR0A = 1 << WGM01;
  TCCR0B = (1 << CS01) | (1 << CS00);   // prescaler 64
  OCR0A = 249;
  TCNT0 = 0;
  TIFR0 = (1 << OCF0A) | (1 << TOV0);
  TIMSK0 = 1 << OCIE0A;

  CONVERSION = CONVERSIONS;
  DIDR0 = 0xff;   // no digital inputs on the pots
  ADCSRB = 0;     // channels 0..7, free-running
  ADMUX = channel(0);
  ADCSRA = ADC_SINGLE | (1 << ADIF);
}

}  // namespace internal

bool tick_pending() { return running != 0; }

TickStart tick_begin() {
  cli();
  const TickStart start = {elapsed, late != 0};
  elapsed = 0;
  late = 0;
  sei();
  return start;
}

void tick_end() {
  internal::missed_ticks = 0;
  running = 0;
}

uint16_t tick_age_us() {
  uint8_t ticks, count;
  do {
    ticks = elapsed;
    count = TCNT0;
  } while (ticks != elapsed);   // a tick in between: read again
  return static_cast<uint16_t>(ticks * 1000u + count * 4u);
}

const uint16_t* pot_sums() { return full ? hal_sums[filling ^ 1] : nullptr; }

void release_pots() {
  memset(hal_sums[filling ^ 1], 0, sizeof hal_sums[0]);
  full = 0;
}

}  // namespace hal
#endif  // __AVR__
