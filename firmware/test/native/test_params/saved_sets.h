// Parameter sets that differ, saved by the store into a fake EEPROM, and what a boot finds there.
#pragma once

#include <doctest/doctest.h>

#include <string.h>

#include <random>

#include "fake_eeprom.h"
#include "params/store.h"

// A REQUIRE for loops of many thousand turns: silent while it holds, where doctest's would report each success.
#define EXPECT(condition)                          \
  do {                                             \
    if (!(condition)) FAIL("not so: " #condition); \
  } while (false)

using Store = params::Store<FakeEeprom&>;
namespace bank = params::bank;

inline params::Table defaults() {
  params::Table table;
  params::load_defaults(table);
  return table;
}

// A valid set that differs from others in many bytes.
inline params::Table variant(unsigned seed) {
  std::mt19937 random(seed);
  params::Table table = defaults();
  table.period_ms = static_cast<uint8_t>(1 + random() % 50);
  table.supply_mv = static_cast<uint16_t>(3000 + random() % 27000);
  for (auto& joint : table.joint) {
    joint.kp = static_cast<uint32_t>(random() % 4194304);
    joint.ki = static_cast<uint32_t>(random() % 65536000);
    joint.limit_min = static_cast<int16_t>(-1 - static_cast<int>(random() % 20000));
    joint.ne_c = static_cast<int16_t>(-static_cast<int>(random() % 16384));
  }
  for (auto& pot : table.follower) pot.zero = static_cast<uint16_t>(random() % 16369);
  EXPECT(params::first_invalid(table) == params::none);
  return table;
}

inline bool same(const params::Table& a, const params::Table& b) { return memcmp(&a, &b, sizeof(a)) == 0; }

inline wire::SaveState save(Store& store, const params::Table& table) {
  store.save(table);
  for (int i = 0; i < 20000 && store.state() == wire::SaveState::saving; ++i) store.poll();
  return store.state();
}

inline wire::SaveState save(FakeEeprom& eeprom, const params::Table& table) {
  Store store(eeprom);
  params::Table loaded;
  store.load(loaded);
  return save(store, table);
}

inline params::Table boot(FakeEeprom& eeprom, wire::ParamSource* source = nullptr) {
  eeprom.power_on();
  Store store(eeprom);
  params::Table table;
  const wire::ParamSource from = store.load(table);
  if (source != nullptr) *source = from;
  return table;
}

// Whether a boot finds that a set was lost.
inline bool lost(FakeEeprom eeprom) {
  eeprom.power_on();
  Store store(eeprom);
  params::Table table;
  store.load(table);
  return store.lost();
}

// An EEPROM after `saves` saves of different sets; `last` is what a boot finds.
inline FakeEeprom history(int saves, params::Table& last) {
  FakeEeprom eeprom;
  last = defaults();
  for (int i = 0; i < saves; ++i) {
    last = variant(static_cast<unsigned>(100 + i));
    EXPECT(save(eeprom, last) == wire::SaveState::saved);
  }
  eeprom.power_on();
  return eeprom;
}
