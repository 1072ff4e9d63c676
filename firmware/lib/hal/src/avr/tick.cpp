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
static_assert(MARK == rail_mark >> 8, "each conversion at a rail adds one");
static_assert(FIRST_POT == pot_count - joint_count, "a round ends with the leaders");

constexpr uint8_t channel(uint8_t n) { return static_cast<uint8_t>((1 << REFS0) | (n & 7)); }  // reference AVcc

// The converter's own inputs at 0 V.
#ifdef MUX4
constexpr uint8_t ground = (1 << REFS0) | 0x1f;
#else
constexpr uint8_t ground = (1 << REFS0) | 0x0f;
#endif

// When the chain starts, in steps of 4 us after the tick: as late as is safe, so that the next tick gets young
// readings. The chain takes 834 us; other interrupts may delay its start and its last conversion by 9 us each.
constexpr uint8_t chain_start = 33;

// Ground is read from the tick on, and then a pot until the chain starts. Both take 26 us.
constexpr uint8_t latest_probe = chain_start - 10;

BEHIND_RINGS volatile uint8_t filling =
    0;                                   // the set of sums to which the interrupt adds; the main loop has the other one
BEHIND_RINGS volatile uint8_t full = 0;  // the main loop's set holds sums that it has not released
BEHIND_RINGS volatile uint8_t running = 0;  // a tick has started and tick_end() has not been called
BEHIND_RINGS volatile uint8_t late = 0;
BEHIND_RINGS volatile uint8_t probed = 0;  // the pot that was read last after ground; 15: none in this tick
BEHIND_RINGS volatile uint8_t probe_count = 0;

// After so many ticks that nobody has begun, the tick's interrupt starts the program anew. It so forestalls the
// watchdog (13 ms at least: its clock is not the processor's), because not every bootloader comes back from a
// watchdog's reset. An EEPROM byte that was being written is done by then.
constexpr uint8_t hung_ticks = 10;

}  // namespace

namespace internal {

BEHIND_RINGS volatile uint8_t elapsed = 0;

uint16_t age_with(uint8_t ticks, uint8_t count) { return static_cast<uint16_t>(ticks * 1000u + count * 4u); }

}  // namespace internal

ISR(TIMER0_COMPA_vect) {
  ADMUX = ground;
  if (CONVERSION == CHAIN_END && !full) {
    filling = filling ^ 1;
    full = 1;
    ADCSRA = ADC_ONCE;
  } else {
    late = 1;
  }
  const auto elapsed = static_cast<uint8_t>(internal::elapsed + 1);
  internal::elapsed = elapsed;
  if (running) {
    pins::drivers_off();
    late = 1;
    if (elapsed == hung_ticks) __asm__ volatile("jmp 0");
  }
  running = 1;
}

// A chain that has not ended by now is given up; the tick's interrupt has already reported it as late. The first
// conversion is started before all other work, so that its moment does not depend on that work.
ISR(TIMER0_COMPB_vect) {
  if (CONVERSION != CHAIN_END) {
    ADCSRA = 0;
    ADMUX = ground;
  }
  const uint8_t pot = ADMUX;
  ADMUX = channel(FIRST_POT);
  ADCSRA = ADC_CHAIN;
  CONVERSION = CHAIN_START;
  SUM_POSITION = static_cast<uint8_t>(reinterpret_cast<uint16_t>(&hal_sums[filling ? 1 : 0][FIRST_POT]));
  probe_count = static_cast<uint8_t>(ADC / 4);
  probed = pot & 15;
  // Conversion 1's channel may be set one ADC clock (32 cycles) after the start, not before.
  __builtin_avr_delay_cycles(12);
  ADMUX = channel(FIRST_POT + 1);
}

namespace internal {

void start_tick() {
  TIMSK0 = 0;  // the framework's millis() interrupt
  TCCR0A = 1 << WGM01;
  TCCR0B = (1 << CS01) | (1 << CS00);  // prescaler 64
  OCR0A = 249;
  OCR0B = chain_start;
  TCNT0 = chain_start - 2;  // a chain starts at once, so that the first tick has samples
  TIFR0 = (1 << OCF0A) | (1 << OCF0B) | (1 << TOV0);
  TIMSK0 = (1 << OCIE0A) | (1 << OCIE0B);

  CONVERSION = CHAIN_END;
  ADMUX = ground;
  DIDR0 = 0xff;  // no digital inputs on the pots
  ADCSRB = 0;    // channels 0..7, free-running
  ADCSRA = ADC_SINGLE | (1 << ADIF);
}

}  // namespace internal

bool tick_pending() { return running != 0; }

TickStart tick_begin() {
  cli();
  UCSR0B = static_cast<uint8_t>(UCSR0B & ~(1 << UDRIE0));  // what is to be sent waits for the end of the tick
  const TickStart start = {internal::elapsed, late != 0};
  internal::elapsed = 0;
  late = 0;
  sei();
  return start;
}

void tick_end() {
  running = 0;
  cli();
  if (hal_tx_head != TX_TAIL) UCSR0B = static_cast<uint8_t>(UCSR0B | (1 << UDRIE0));
  sei();
}

const uint16_t* pot_sums() {
  if (!full) return nullptr;
  const uint16_t* sums = filling ? hal_sums[0] : hal_sums[1];
  if (sums == nullptr) __builtin_unreachable();  // it would be asked, as an AVR may have a variable at 0
  return sums;
}

// The tick has had its sums for some time: ground has been read, unless the tick is late.
void release_pots(uint8_t probed) {
  full = 0;
  if (TCNT0 > latest_probe || CONVERSION != CHAIN_END || (ADCSRA & (1 << ADSC)) != 0) return;
  ADMUX = channel(probed);
  pins::pull_up_pots(static_cast<uint8_t>(~pot_bit(probed)));
  ADCSRA = ADC_ONCE;
}

Probe last_probe() {
  cli();
  const uint8_t pot = probed, count = probe_count;
  sei();
  const uint16_t* sums = hal_sums[filling ? 0 : 1];
  return {pot, count, static_cast<uint8_t>(sums[pot & 7] / 16)};
}

}  // namespace hal
#endif  // __AVR__
