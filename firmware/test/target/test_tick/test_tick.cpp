// The tick's period and jitter while everything interrupts, and what happens when one is not finished in time.
#include <Arduino.h>
#include <hal.h>

#include "../report.h"

namespace {

constexpr uint16_t cycles_per_tick = 16000;
constexpr uint8_t enable = 1 << PH6;
constexpr uint16_t ticks = 1000;

// Timer 1 counts cycles; a tick is well below its range.
void start_stopwatch() {
  TCCR1A = 0;
  TCCR1B = 1 << CS10;
}

uint16_t cycles() {
  cli();
  const uint16_t now = TCNT1;
  sei();
  return now;
}

void period() {
  uint8_t load[100];
  memset(load, '\n', sizeof load);   // blank lines: the report's reader skips them
  uint16_t shortest = 0xffff, longest = 0, late = 0;
  uint32_t sum = 0;
  catch_up();
  wait_for_tick();
  uint16_t before = cycles();
  finish_tick();
  for (uint16_t i = 0; i < ticks; ++i) {
    if (hal::tx_free() >= sizeof load) hal::tx_write(load, sizeof load);   // the transmitter is never idle
    wait_for_tick();
    const uint16_t now = cycles();
    const uint16_t period = static_cast<uint16_t>(now - before);
    before = now;
    late += finish_tick();
    sum += period;
    if (period < shortest) shortest = period;
    if (period > longest) longest = period;
  }
  WITHIN("mean_period_is_1_ms", sum / ticks, cycles_per_tick - 1, cycles_per_tick + 1);
  WITHIN("jitter_is_below_10_us_early", shortest, cycles_per_tick - 160, cycles_per_tick);
  WITHIN("jitter_is_below_10_us_late", longest, cycles_per_tick, cycles_per_tick + 160);
  EQUAL("no_tick_is_late_under_load", late, 0);
}

void age() {
  catch_up();
  wait_for_tick();
  hal::tick_begin();
  const uint16_t at_start = hal::tick_age_us();
  __builtin_avr_delay_cycles(300UL * 16);
  const uint16_t middle = hal::tick_age_us();
  finish_tick();
  WITHIN("age_at_the_start", at_start, 0, 12);
  WITHIN("age_counts_time_and_interrupts", middle, 300, 400);
}

void overrun() {
  catch_up();
  wait_for_tick();
  hal::tick_begin();
  hal::set_drivers(true);
  EQUAL("drivers_are_on", PORTH & enable, enable);
  const uint16_t start = cycles();
  uint16_t waited = 0;
  while ((PORTH & enable) && waited < 40000) waited = static_cast<uint16_t>(cycles() - start);
  WITHIN("an_unfinished_tick_turns_the_drivers_off_at_the_next", waited, 1, cycles_per_tick + 100);
  while (hal::tick_age_us() < 2500) {
  }
  WITHIN("age_goes_on_over_missed_ticks", hal::tick_age_us(), 2500, 2520);
  hal::tick_end();
  wait_for_tick();
  hal::TickStart start_after = hal::tick_begin();
  EQUAL("the_next_tick_is_told", start_after.late, true);
  EQUAL("and_how_many_it_missed", start_after.elapsed, 3);
  hal::release_pots();
  hal::tick_end();
  wait_for_tick();
  finish_tick();
  wait_for_tick();
  EQUAL("afterwards_ticks_are_in_time_again", hal::tick_begin().late, false);
  EQUAL("with_fresh_samples", hal::pot_sums() != nullptr, true);
  hal::release_pots();
  hal::tick_end();
}

}  // namespace

void setup() {
  hal::begin();
  start_stopwatch();
  age();
  period();
  overrun();
  report::end();
}

void loop() {}
