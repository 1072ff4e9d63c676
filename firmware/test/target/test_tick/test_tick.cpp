// The tick's period and jitter while everything interrupts, and what happens when one is not finished in time.
#include <avr/shared_state.h>
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

struct Periods {
  uint16_t shortest, longest, late;
  uint32_t sum;
};

// Of a thousand ticks as the main loop sees them, with the ADC chain and, if wanted, a transmitter that never rests:
// the wire from TX to RX makes that full speed both ways, the heaviest load there is.
Periods measure(bool talk) {
  uint8_t load[100];
  memset(load, '\n', sizeof load);  // blank lines: the report's reader skips them
  Periods p = {0xffff, 0, 0, 0};
  catch_up();
  wait_for_tick();
  uint16_t before = cycles();
  finish_tick();
  for (uint16_t i = 0; i < ticks; ++i) {
    if (talk && hal::tx_free() >= sizeof load) hal::tx_write(load, sizeof load);
    wait_for_tick();
    const uint16_t now = cycles();
    const uint16_t period = static_cast<uint16_t>(now - before);
    before = now;
    p.late += finish_tick();
    p.sum += period;
    if (period < p.shortest) p.shortest = period;
    if (period > p.longest) p.longest = period;
  }
  return p;
}

void period() {
  const Periods quiet = measure(false), busy = measure(true);
  WITHIN("mean_period_is_1_ms", (quiet.sum + ticks / 2) / ticks, cycles_per_tick, cycles_per_tick);
  WITHIN("jitter_is_below_5_us_early", quiet.shortest, cycles_per_tick - 80, cycles_per_tick);
  WITHIN("jitter_is_below_5_us_late", quiet.longest, cycles_per_tick, cycles_per_tick + 80);
  EQUAL("no_tick_is_late", quiet.late, 0);
  WITHIN("mean_period_is_1_ms_under_load", busy.sum / ticks, cycles_per_tick - 1, cycles_per_tick + 1);
  WITHIN("jitter_is_below_20_us_early_under_load", busy.shortest, cycles_per_tick - 320, cycles_per_tick);
  WITHIN("jitter_is_below_20_us_late_under_load", busy.longest, cycles_per_tick, cycles_per_tick + 320);
  EQUAL("no_tick_is_late_under_load", busy.late, 0);
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

struct Next {
  bool late, fresh;
};

// What the next tick is told, and whether it is given samples.
Next next_tick() {
  wait_for_tick();
  const bool late = hal::tick_begin().late;
  const bool fresh = hal::pot_sums() != nullptr;
  hal::release_pots(0);
  hal::end_pull_ups();
  hal::tick_end();
  return {late, fresh};
}

void broken_chain() {
  catch_up();
  wait_for_tick();
  finish_tick();
  while (hal::tick_age_us() < 500) {
  }
  ADCSRA = 0;  // in the middle of the conversions
  wait_for_tick();
  const bool told = hal::tick_begin().late;
  const bool none = hal::pot_sums() == nullptr;
  hal::tick_end();
  for (uint8_t i = 0; i < 2; ++i) {
    wait_for_tick();
    finish_tick();
  }
  const Next next = next_tick();
  EQUAL("an_unfinished_chain_is_told_at_the_next_tick", told, true);
  EQUAL("and_its_samples_are_not_given", none, true);
  EQUAL("a_new_chain_mends_it", next.late, false);
  EQUAL("with_samples", next.fresh, true);
}

// How long the chain takes from tick to tick, under load: what is left is the margin before the next tick.
void margin() {
  uint8_t load[100];
  memset(load, '\n', sizeof load);
  uint16_t latest = 0;
  catch_up();
  for (uint16_t i = 0; i < ticks; ++i) {
    wait_for_tick();
    finish_tick();
    if (hal::tx_free() >= sizeof load) hal::tx_write(load, sizeof load);
    while (hal::tick_age_us() < 400) {
    }
    while (GPIOR0 != CHAIN_END) {
    }
    const uint16_t age = hal::tick_age_us();
    if (age > latest) latest = age;
  }
  WITHIN("the_last_conversion_is_in_20_us_before_the_tick_at_most", latest, 960, 980);
}

// The probe of a pot in a tick that releases its sums so late.
hal::Probe probed(uint8_t pot, uint16_t release_us) {
  wait_for_tick();
  hal::tick_begin();
  while (hal::tick_age_us() < release_us) {
  }
  hal::release_pots(pot);
  hal::end_pull_ups();
  hal::tick_end();
  while (hal::tick_age_us() < 200) {
  }
  return hal::last_probe();
}

void probes() {
  catch_up();
  uint8_t right = 0;
  for (uint8_t pot = 0; pot < 8; ++pot) {
    const hal::Probe probe = probed(pot, 40);
    if (probe.pot == pot && probe.count == probe.usual) ++right;
  }
  EQUAL("each_pot_reads_after_ground_what_it_reads_among_the_others", right, 8);
  EQUAL("and_the_pull_ups_are_off_again", PORTF, 0);
  EQUAL("not_before_ground_has_been_read", probed(3, 16).pot >= hal::pot_count, true);
  EQUAL("nor_once_the_chain_is_near", probed(3, 120).pot >= hal::pot_count, true);
  const Next next = next_tick();
  EQUAL("the_chain_is_as_ever", next.late, false);
  EQUAL("and_has_its_samples", next.fresh, true);
}

void overrun() {
  catch_up();
  wait_for_tick();
  hal::tick_begin();
  hal::set_drivers(true);
  const uint8_t on = PORTH & enable;
  const uint16_t start = cycles();
  uint16_t waited = 0;
  while ((PORTH & enable) && waited < 40000) waited = static_cast<uint16_t>(cycles() - start);
  while (hal::tick_age_us() < 2500) {
  }
  const uint16_t age = hal::tick_age_us();
  hal::tick_end();
  wait_for_tick();
  const hal::TickStart after = hal::tick_begin();
  hal::release_pots(0);
  hal::end_pull_ups();
  hal::tick_end();
  wait_for_tick();
  finish_tick();
  const Next next = next_tick();
  EQUAL("drivers_are_on", on, enable);
  WITHIN("an_unfinished_tick_turns_the_drivers_off_at_the_next", waited, 1, cycles_per_tick + 100);
  EQUAL("and_they_stay_off", PORTH & enable, 0);
  WITHIN("age_goes_on_over_missed_ticks", age, 2500, 2520);
  EQUAL("the_next_tick_is_told", after.late, true);
  EQUAL("and_how_many_it_missed", after.elapsed, 3);
  EQUAL("afterwards_ticks_are_in_time_again", next.late, false);
  EQUAL("with_fresh_samples", next.fresh, true);
}

}  // namespace

int main() {
  hal::begin();
  start_stopwatch();
  age();
  period();
  margin();
  broken_chain();
  probes();
  overrun();
  report::end();
}
