// The real store on the real EEPROM registers, while ticks go on.
#include <Arduino.h>
#include <hal.h>
#include <parameter_sets.h>

#include "../report.h"

namespace {

app::HalEeprom eeprom;
params::Table saved, found;
uint16_t late = 0;

bool same(const params::Table& a, const params::Table& b) { return memcmp(&a, &b, sizeof a) == 0; }

// As the firmware does it: a step at a time between ticks. Milliseconds until it is done.
uint16_t save(params::Store<app::HalEeprom>& store, const params::Table& table) {
  catch_up();
  store.save(table);
  uint16_t ms = 0;
  while (store.state() == wire::SaveState::saving && ms < 5000) {
    if (hal::tick_pending()) {
      late += finish_tick();
      ++ms;
    } else {
      store.poll();
    }
  }
  return ms;
}

wire::ParamSource load(params::Table& table) {
  params::Store<app::HalEeprom> fresh(eeprom);  // as after a reset
  memset(&table, 0, sizeof table);
  return fresh.load(table);
}

uint8_t number(wire::ParamSource source) { return static_cast<uint8_t>(source); }

}  // namespace

void setup() {
  hal::begin();
  params::Store<app::HalEeprom> store(eeprom);
  params::load_defaults(saved);

  EQUAL("a_blank_eeprom_gives_defaults", number(store.load(found)), number(wire::ParamSource::defaults));
  EQUAL("whole_defaults", same(found, saved), true);

  saved.supply_mv = 12345;
  saved.joint[3].pce_b = 15000;
  WITHIN("a_first_save_takes_3_4_ms_a_byte", save(store, saved), 500, 800);
  EQUAL("it_succeeds", static_cast<uint8_t>(store.state()), static_cast<uint8_t>(wire::SaveState::saved));
  EQUAL("it_goes_to_bank_a", number(load(found)), number(wire::ParamSource::bank_a));
  EQUAL("it_is_read_back_whole", same(found, saved), true);

  saved.supply_mv = 6789;
  save(store, saved);
  EQUAL("the_next_goes_to_bank_b", number(load(found)), number(wire::ParamSource::bank_b));
  EQUAL("and_is_the_one_read_back", same(found, saved), true);

  const uint16_t again = save(store, saved);
  WITHIN("a_set_that_is_stored_already_is_not_written", again, 0, 10);

  hal::eeprom_begin_write(params::bank::start_b + 20, 0x5a);
  EQUAL("a_write_takes_its_time", hal::eeprom_busy(), true);
  while (hal::eeprom_busy()) {
  }
  EQUAL("and_arrives", hal::eeprom_read(params::bank::start_b + 20), 0x5a);
  EQUAL("a_spoilt_bank_gives_way_to_the_other", number(load(found)), number(wire::ParamSource::bank_a));
  EQUAL("which_holds_the_set_before", found.supply_mv, 12345);
  EQUAL("no_tick_was_late", late, 0);
  report::end();
}

void loop() {}
