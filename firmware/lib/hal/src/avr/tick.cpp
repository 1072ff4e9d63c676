// The 1 kHz tick and the start of each chain of 32 ADC conversions by timer 0 (interrupts.S goes on with the chain).
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../hal.h"
#include "internal.h"
#include "shared_state.h"

namespace hal {
namespace {

static_assert(CONVERSIONS == pot_count * conversions_per_pot, "each pot in turn, the same number of times");
static_assert(FIRST_POT == pot_count - joint_count, "a round ends with the leaders");

constexpr uint8_t channel(uint8_t n) { return static_cast<uint8_t>((1 << REFS0) | (n & 7)); }   // reference AVcc

// When the chain starts, in steps of 4 us after the tick: as late as it safely can, so that what the next tick uses is young.
// It takes 834 us; other interrupts may hold up its start and its last conversion by 9 us each.
constexpr uint8_t chain_start = 33;

volatile uint8_t filling = 0;   // of the two sets of sums; the interrupt adds there, the other one is the main loop's
volatile uint8_t full = 0;      // the main loop's one holds sums that it has not released
volatile uint8_t running = 0;   // a tick has started and tick_end() has not been called
volatile uint8_t late = 0;

}  // namespace

namespace internal {

volatile uint8_t elapsed = 0;

uint16_t age_with(uint8_t ticks, uint8_t count) { return static_cast<uint16_t>(ticks * 1000u + count * 4u); }

}  // namespace internal

ISR(TIMER0_COMPA_vect) {
  if (CONVERSION == CHAIN_END && !full) {
    filling = filling ^ 1;
    full = 1;
  } else {
    late = 1;
  }
  internal::elapsed = static_cast<uint8_t>(internal::elapsed + 1);
  if (running) {
    pins::drivers_off();
    late = 1;
    const uint8_t missed = internal::missed_ticks;
    if (missed != 255) internal::missed_ticks = static_cast<uint8_t>(missed + 1);
  }
  running = 1;
}

// The first conversion is started before anything else: its moment does not depend on the work below. A chain that has not
// ended by now was unfinished at the tick, which has told; this one replaces it.
ISR(TIMER0_COMPB_vect) {
  if (CONVERSION != CHAIN_END) {
    ADCSRA = 0;
    ADMUX = channel(FIRST_POT);
  }
  ADCSRA = ADC_CHAIN;   // its channel was chosen by the last interrupt of the chain before
  CONVERSION = CHAIN_START;
  SUM_POSITION = static_cast<uint8_t>(reinterpret_cast<uint16_t>(&hal_sums[filling ? 1 : 0][FIRST_POT]));
  __builtin_avr_delay_cycles(16);   // the channel of conversion 1: allowed one ADC clock (32 cycles) after the start
  ADMUX = channel(FIRST_POT + 1);
}

namespace internal {

void start_tick() {
  TIMSK0 = 0;   // the framework's millis() interrupt
  TCCR0A = 1 << WGM01;
  TCCR0B = (1 << CS01) | (1 << CS00);   // prescaler 64
  OCR0A = 249;
  OCR0B = chain_start;
  TCNT0 = chain_start - 2;   // the first tick comes with samples
  TIFR0 = (1 << OCF0A) | (1 << OCF0B) | (1 << TOV0);
  TIMSK0 = (1 << OCIE0A) | (1 << OCIE0B);

  CONVERSION = CHAIN_END;
  DIDR0 = 0xff;   // no digital inputs on the pots
  ADCSRB = 0;     // channels 0..7, free-running
  ADMUX = channel(FIRST_POT);
  ADCSRA = ADC_SINGLE | (1 << ADIF);
}

}  // namespace internal

bool tick_pending() { return running != 0; }

TickStart tick_begin() {
  cli();
  const TickStart start = {internal::elapsed, late != 0};
  internal::elapsed = 0;
  late = 0;
  sei();
  return start;
}

void tick_end() {
  internal::missed_ticks = 0;
  running = 0;
}

const uint16_t* pot_sums() { return !full ? nullptr : filling ? hal_sums[0] : hal_sums[1]; }

void release_pots() { full = 0; }

}  // namespace hal
#endif  // __AVR__
