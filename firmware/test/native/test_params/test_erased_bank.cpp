// A bank that was erased whole looks like one that never held a set. The other bank tells that it did, but for a board
// that has saved twice only: without bank B it looks like one that has saved once.
#include <doctest/doctest.h>

#include <algorithm>

#include "expect.h"
#include "fake_eeprom.h"
#include "params/store.h"

namespace {

using Store = params::Store<FakeEeprom&>;
namespace bank = params::bank;

// Saves sets in turn, with a boot before each.
FakeEeprom after_saves(int saves) {
  FakeEeprom eeprom;
  for (int i = 1; i <= saves; ++i) {
    Store store(eeprom);
    params::Table table;
    store.load(table);
    table.supply_mv = static_cast<uint16_t>(5000 + i);
    store.save(table);
    while (store.state() == wire::SaveState::saving) store.poll();
    REQUIRE((store.state() == wire::SaveState::saved));
    eeprom.power_on();
  }
  return eeprom;
}

void erase(FakeEeprom& eeprom, uint16_t start) {
  std::fill_n(eeprom.cells.begin() + start, bank::size, static_cast<uint8_t>(0xFF));
}

struct Boot {
  bool lost;
  uint16_t supply_mv;
};

Boot boot(FakeEeprom& eeprom) {
  eeprom.power_on();
  Store store(eeprom);
  params::Table table;
  store.load(table);
  return {store.lost(), table.supply_mv};
}

}  // namespace

TEST_CASE("a bank that was erased is told as lost, whichever it was, and a save mends it") {
  for (int saves = 3; saves < 7; ++saves) {
    for (const uint16_t start : {bank::start_a, bank::start_b}) {
      CAPTURE(saves);
      CAPTURE(start);
      FakeEeprom eeprom = after_saves(saves);
      CHECK_FALSE(boot(eeprom).lost);
      erase(eeprom, start);
      const bool was_newest = (start == bank::start_a) == (saves % 2 == 1);
      const Boot found = boot(eeprom);
      CHECK(found.lost);
      CHECK(found.supply_mv == 5000 + saves - was_newest);
      Store store(eeprom);
      params::Table table;
      store.load(table);
      store.save(table);
      while (store.state() == wire::SaveState::saving) store.poll();
      CHECK_FALSE(store.lost());
      CHECK_FALSE(boot(eeprom).lost);
    }
  }
}

TEST_CASE("a board that has saved once has one bank, and nothing is lost") {
  FakeEeprom eeprom = after_saves(1);
  CHECK_FALSE(boot(eeprom).lost);
  CHECK(boot(eeprom).supply_mv == 5001);
}

TEST_CASE("bank A is never the blank one beside a whole bank B") {
  FakeEeprom eeprom = after_saves(2);
  erase(eeprom, bank::start_a);
  CHECK(boot(eeprom).lost);
  CHECK(boot(eeprom).supply_mv == 5002);
}

TEST_CASE("the first save after rot begins to count at 1, whatever the rot has left of a sequence number") {
  FakeEeprom eeprom = after_saves(1);
  eeprom.cells.at(bank::start_a + size_t{bank::sequence_at}) = 0x77;
  CHECK(boot(eeprom).lost);
  Store store(eeprom);
  params::Table table;
  store.load(table);
  store.save(table);
  while (store.state() == wire::SaveState::saving) store.poll();
  CHECK_FALSE(boot(eeprom).lost);
}
