// The ADC chain: with 250, 750, 1250, 1750, 2250, 2750, 3250 and 4750 mV at ADC0..7, each pot reads its own voltage.
#include <Arduino.h>
#include <hal.h>

#include "../report.h"

namespace {

constexpr uint16_t millivolts[hal::pot_count] = {250, 750, 1250, 1750, 2250, 2750, 3250, 4750};
constexpr uint16_t ticks = 200;

uint16_t incomplete = 0, late = 0, jumps = 0;
uint16_t first[hal::pot_count], last[hal::pot_count];

void one_tick(uint16_t number) {
  while (!hal::tick_pending()) hal::idle();
  late += hal::tick_begin().late;
  const uint16_t* const sums = hal::pot_sums();
  if (sums) memcpy(last, sums, sizeof last);
  else ++incomplete;
  hal::release_pots();
  if (number == 1) memcpy(first, last, sizeof last);
  if (number > 1) jumps += memcmp(first, last, sizeof last) != 0;
  hal::tick_end();
}

}  // namespace

void setup() {
  hal::begin();
  for (uint16_t i = 0; i < ticks; ++i) one_tick(i);  // tick 0 has the sums of no conversions yet
  for (uint8_t i = 0; i < hal::pot_count; ++i) {
    const long sum = 4L * millivolts[i] * 1024 / 5000;
    WITHIN("pot_reads_its_own_voltage", last[i], sum - 4, sum + 4);
  }
  EQUAL("every_tick_has_its_samples", incomplete, 0);
  EQUAL("steady_voltages_read_steadily", jumps, 0);
  EQUAL("no_tick_is_late", late, 0);
  catch_up();
  wait_for_tick();
  EQUAL("samples_are_there", hal::pot_sums() != nullptr, true);
  hal::release_pots();
  EQUAL("until_they_are_released", hal::pot_sums() != nullptr, false);
  report::end();
}

void loop() {}
