// A bank that was erased whole looks like one that never held a set. The other bank tells that it did, but for a board
// that has saved twice only: without bank B it looks like one that has saved once. The attacks try what boards that
// have saved more often do.
#include <algorithm>

#include "saved_sets.h"

TEST_CASE("a board that has saved once has one bank, and nothing is lost") {
  params::Table newest;
  FakeEeprom eeprom = history(1, newest);
  CHECK_FALSE(lost(eeprom));
  CHECK(same(boot(eeprom), newest));
}

TEST_CASE("bank A is never the blank one beside a whole bank B") {
  params::Table newest;
  FakeEeprom eeprom = history(2, newest);
  std::fill_n(eeprom.cells.begin() + bank::start_a, bank::size, static_cast<uint8_t>(0xFF));
  CHECK(lost(eeprom));
  CHECK(same(boot(eeprom), newest));
}

TEST_CASE("the first save after rot begins to count at 1, whatever the rot has left of a sequence number") {
  params::Table newest;
  FakeEeprom eeprom = history(1, newest);
  eeprom.cells.at(bank::start_a + size_t{bank::sequence_at}) = 0x77;
  CHECK(lost(eeprom));
  CHECK(save(eeprom, variant(5)) == wire::SaveState::saved);
  CHECK_FALSE(lost(eeprom));
}
