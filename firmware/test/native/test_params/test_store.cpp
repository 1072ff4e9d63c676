// The two-bank store: power cut at every write with every torn value, wear, rot, wrap-around, other layouts.
#include "saved_sets.h"

namespace {

// Recomputes the CRC of a bank that a test has changed by hand.
void reseal(FakeEeprom& eeprom, uint16_t start) {
  wire::Crc16 crc;
  for (int i = bank::layout_at; i < bank::crc_at; ++i) crc.add(eeprom.cells.at(static_cast<size_t>(start + i)));
  eeprom.cells.at(start + size_t{bank::crc_at}) = crc.low();
  eeprom.cells.at(start + size_t{bank::crc_at} + 1) = crc.high();
}

}  // namespace

TEST_CASE("a blank EEPROM gives the defaults and is not written") {
  for (const uint8_t fill : {uint8_t{0xFF}, uint8_t{0x00}, uint8_t{0x47}}) {
    FakeEeprom eeprom;
    eeprom.cells.assign(FakeEeprom::size, fill);
    wire::ParamSource source;
    CHECK(same(boot(eeprom, &source), defaults()));
    CHECK(source == wire::ParamSource::defaults);
    CHECK(eeprom.writes == 0);
    CHECK(lost(eeprom) == (fill != 0xFF));  // what another program left behind is no blank EEPROM
  }
}

TEST_CASE("what is saved is found at boot, the banks taking turns") {
  FakeEeprom eeprom;
  for (unsigned i = 0; i < 6; ++i) {
    const params::Table table = variant(i);
    EXPECT(save(eeprom, table) == wire::SaveState::saved);
    wire::ParamSource source;
    EXPECT(same(boot(eeprom, &source), table));
    CHECK(source == (i % 2 == 0 ? wire::ParamSource::bank_a : wire::ParamSource::bank_b));
  }
}

TEST_CASE("a power cut at any write, with any torn byte, leaves the old or the new set whole") {
  long cuts = 0;
  long found_old = 0;
  long found_new = 0;
  long found_lost = 0;
  for (int saves = 0; saves <= 2; ++saves) {  // both banks blank, then one, then none
    params::Table old_table;
    const FakeEeprom before = history(saves, old_table);
    const params::Table new_table = variant(7);
    FakeEeprom whole = before;
    EXPECT(save(whole, new_table) == wire::SaveState::saved);
    EXPECT(whole.writes > 50);
    for (int cut = 1; cut <= whole.writes; ++cut) {
      for (int torn = FakeEeprom::untouched; torn < 256; ++torn) {
        FakeEeprom eeprom = before;
        eeprom.cut_at = cut;
        eeprom.torn = torn;
        bool was_cut = false;
        try {
          save(eeprom, new_table);
        } catch (const PowerCut&) {
          was_cut = true;
        }
        EXPECT(was_cut);
        const params::Table found = boot(eeprom);
        const bool is_old = same(found, old_table);
        const bool is_new = same(found, new_table);
        EXPECT((is_old || is_new));
        // A save that has begun is lost, unless the cut came so early or so late that both banks are whole or blank.
        const bool is_lost = lost(eeprom);
        if (cut > 1 && is_old) EXPECT(is_lost);
        if (is_new) EXPECT(!is_lost);
        found_lost += is_lost ? 1 : 0;
        found_old += is_old ? 1 : 0;
        found_new += is_new ? 1 : 0;
        ++cuts;
        if (torn % 64 == 0) {  // and the store still works afterwards
          const params::Table next = variant(8);
          EXPECT(save(eeprom, next) == wire::SaveState::saved);
          EXPECT(same(boot(eeprom), next));
          EXPECT(!lost(eeprom));
        }
      }
    }
  }
  MESSAGE(cuts, " power cuts: ", found_old, " boots found the old set, ", found_new, " the new one, ", found_lost,
          " told of a lost set");
  CHECK(found_new >= 3);  // a cut in the last write whose byte came out right
}

TEST_CASE("a half-written bank is never taken, even when its CRC happens to be right") {
  params::Table newest;
  const FakeEeprom before = history(2, newest);  // bank A: variant(100), sequence 1; the save goes there, as sequence 3
  constexpr int kp_at = bank::payload_at + 13 + 16;
  const auto crc_up_to_kp = [](const FakeEeprom& eeprom, int sequence, uint16_t low) {
    wire::Crc16 crc;
    for (int i = bank::layout_at; i < kp_at; ++i) {
      const uint8_t byte = eeprom.cells.at(static_cast<size_t>(bank::start_a + i));
      crc.add(i == bank::sequence_at ? static_cast<uint8_t>(sequence) : byte);
    }
    crc.add(static_cast<uint8_t>(low & 0xFF));
    crc.add(static_cast<uint8_t>(low >> 8));
    return crc.value();
  };
  // A new set whose first part brings the CRC to where the old first part brought it: the old rest and the old CRC fit
  // it.
  params::Table next = variant(100);
  const uint32_t old_kp = next.joint[0].kp;
  const uint16_t target = crc_up_to_kp(before, 1, static_cast<uint16_t>(old_kp & 0xFFFF));
  uint32_t low = 0;
  while (low < 0x10000 && crc_up_to_kp(before, 3, static_cast<uint16_t>(low)) != target) ++low;
  REQUIRE(low < 0x10000);
  next.joint[0].kp = (old_kp & 0xFF0000) | low;
  next.joint[3].pce_b = 1234;

  FakeEeprom whole = before;
  REQUIRE(save(whole, next) == wire::SaveState::saved);
  for (int cut = 1; cut <= whole.writes; ++cut) {
    FakeEeprom eeprom = before;
    eeprom.cut_at = cut;
    eeprom.torn = FakeEeprom::untouched;
    CHECK_THROWS_AS(save(eeprom, next), PowerCut);
    CHECK(same(boot(eeprom), newest));
  }
}

TEST_CASE("a set that is stored already costs no write") {
  FakeEeprom eeprom;
  const params::Table table = variant(1);
  EXPECT(save(eeprom, table) == wire::SaveState::saved);
  eeprom.writes = 0;
  Store store(eeprom);
  params::Table loaded;
  store.load(loaded);
  CHECK(save(store, table) == wire::SaveState::saved);
  CHECK(save(store, table) == wire::SaveState::saved);
  CHECK(eeprom.writes == 0);
}

TEST_CASE("bytes that are right already are not worn") {
  FakeEeprom eeprom;
  params::Table table = variant(1);
  for (int i = 0; i < 1000; ++i) {
    table.period_ms = static_cast<uint8_t>(1 + i % 50);
    EXPECT(save(eeprom, table) == wire::SaveState::saved);
  }
  // Per save: the magic byte twice, the low byte of the sequence, the period, two bytes of CRC; now and then one more.
  CHECK(eeprom.writes < 1000 * 6 + 2 * params::table_size + 20);
  int worst = 0;
  for (const int wear : eeprom.wear) worst = wear > worst ? wear : worst;
  CHECK(worst <= 1001);
  CHECK(worst >= 999);
  Store store(eeprom);
  store.load(table);
  CHECK(store.sequence() == 1000);  // so it tells the wear of the worst cell
}

TEST_CASE("rot that is found while saving is healed by a fresh bank") {
  params::Table newest;
  FakeEeprom eeprom = history(2, newest);
  Store store(eeprom);
  params::Table loaded;
  store.load(loaded);
  eeprom.cells.at(bank::start_b + 50) ^= 0x10;
  CHECK(save(store, newest) == wire::SaveState::saved);
  wire::ParamSource source;
  CHECK(same(boot(eeprom, &source), newest));
  CHECK(source == wire::ParamSource::bank_a);
}

TEST_CASE("the sequence number wraps around") {
  for (const unsigned begin : {0xFFFCu, 0x7FFCu}) {
    params::Table last;
    FakeEeprom eeprom = history(1, last);
    eeprom.cells.at(bank::start_a + bank::sequence_at) = static_cast<uint8_t>(begin & 0xFF);
    eeprom.cells.at(bank::start_a + bank::sequence_at + 1) = static_cast<uint8_t>(begin >> 8);
    reseal(eeprom, bank::start_a);
    for (unsigned i = 0; i < 8; ++i) {
      const params::Table table = variant(i);
      EXPECT(save(eeprom, table) == wire::SaveState::saved);
      CHECK(same(boot(eeprom), table));
    }
  }
}

TEST_CASE("banks of another layout or length are left alone until they are needed") {
  for (const int at : {int{bank::layout_at}, int{bank::length_at}}) {
    params::Table newest;
    FakeEeprom eeprom = history(2, newest);
    for (const uint16_t start : {bank::start_a, bank::start_b}) {
      eeprom.cells.at(static_cast<size_t>(start + at)) ^= 0x05;
      reseal(eeprom, start);
    }
    wire::ParamSource source;
    CHECK(same(boot(eeprom, &source), defaults()));
    CHECK(source == wire::ParamSource::defaults);
    CHECK(lost(eeprom));
    CHECK(save(eeprom, variant(9)) == wire::SaveState::saved);
    CHECK(same(boot(eeprom), variant(9)));
    CHECK_FALSE(lost(eeprom));
  }
}

namespace {

// Makes of a bank what an older firmware wrote: the beginning of the table only.
void turn_into(uint8_t old, FakeEeprom& eeprom, uint16_t start) {
  const int end = bank::payload_at + params::layout_sizes[old - 1];
  const auto cell = [&](int at) -> uint8_t& { return eeprom.cells.at(static_cast<size_t>(start + at)); };
  cell(bank::layout_at) = old;
  cell(bank::length_at) = params::layout_sizes[old - 1];
  wire::Crc16 crc;
  for (int i = bank::layout_at; i < end; ++i) crc.add(cell(i));
  cell(end) = crc.low();
  cell(end + 1) = crc.high();
  for (int i = end + 2; i < bank::size; ++i) cell(i) = 0xFF;
}

}  // namespace

TEST_CASE("a bank of an older layout keeps its values, the rest gets its defaults, and a save writes today's layout") {
  constexpr int older = params::layout - 1;
  for (int i = 0; i < 3 * older; ++i) {
    const int saves = 1 + i / older;
    const auto old = static_cast<uint8_t>(1 + i % older);
    params::Table newest;
    FakeEeprom eeprom = history(saves, newest);
    turn_into(old, eeprom, bank::start_a);
    if (saves > 1) turn_into(old, eeprom, bank::start_b);
    CHECK(same(boot(eeprom), newest));
    CHECK_FALSE(lost(eeprom));
    params::Table changed = newest;
    changed.unrest_amplitude = 33;
    changed.change[3].ce_ticks = 7;
    FakeEeprom before = eeprom;
    CHECK(save(eeprom, newest) == wire::SaveState::saved);
    CHECK(same(boot(eeprom), newest));
    CHECK(save(eeprom, changed) == wire::SaveState::saved);
    CHECK(same(boot(eeprom), changed));
    CHECK_FALSE(lost(eeprom));
    const auto last = static_cast<size_t>(bank::payload_at + params::layout_sizes[old - 1] - 1);
    const size_t spoilt = (saves == 2 ? bank::start_b : bank::start_a) + last;
    before.cells.at(spoilt) ^= 1;  // the last byte of the newest
    CHECK_FALSE(same(boot(before), newest));
    CHECK(lost(before));
  }
}

TEST_CASE("a whole bank with a value out of range is passed over, and the next save outranks it") {
  params::Table newest;
  FakeEeprom eeprom = history(2, newest);
  eeprom.cells.at(bank::start_b + bank::payload_at) = 0;  // period_ms
  reseal(eeprom, bank::start_b);
  wire::ParamSource source;
  CHECK(same(boot(eeprom, &source), variant(100)));
  CHECK(source == wire::ParamSource::bank_a);
  CHECK(lost(eeprom));
  CHECK(save(eeprom, variant(11)) == wire::SaveState::saved);
  CHECK(same(boot(eeprom), variant(11)));
  CHECK_FALSE(lost(eeprom));
}

TEST_CASE("a lost set is told until a save has made both banks whole, also a save of the set that runs") {
  for (const uint16_t start : {bank::start_a, bank::start_b}) {
    params::Table newest;
    FakeEeprom eeprom = history(2, newest);
    eeprom.cells.at(start + 20U) ^= 0x40;
    Store store(eeprom);
    params::Table runs;
    store.load(runs);
    CHECK(same(runs, start == bank::start_b ? variant(100) : newest));
    CHECK(store.lost());
    CHECK(save(store, runs) == wire::SaveState::saved);
    CHECK_FALSE(store.lost());
    CHECK_FALSE(lost(eeprom));
    CHECK(same(boot(eeprom), runs));
  }
}

TEST_CASE("both banks lost: the first save writes both, and a power cut in it is told") {
  params::Table newest;
  FakeEeprom before = history(2, newest);
  before.cells.at(bank::start_a + 20U) ^= 0x40;
  before.cells.at(bank::start_b + 20U) ^= 0x40;
  FakeEeprom whole = before;
  REQUIRE(save(whole, variant(7)) == wire::SaveState::saved);
  CHECK_FALSE(lost(whole));
  for (int cut = 1; cut < whole.writes; ++cut) {
    FakeEeprom eeprom = before;
    eeprom.cut_at = cut;
    eeprom.torn = 0x5A;
    CHECK_THROWS_AS(save(eeprom, variant(7)), PowerCut);
    EXPECT(lost(eeprom));
    const params::Table found = boot(eeprom);
    EXPECT((same(found, defaults()) || same(found, variant(7))));
  }
}

TEST_CASE("a worn-out cell is reported, and the last good set stays") {
  params::Table newest;
  const FakeEeprom before = history(2, newest);
  int failures = 0;
  for (int at = 0; at < bank::size; ++at) {
    FakeEeprom eeprom = before;
    eeprom.stuck = bank::start_a + at;
    const wire::SaveState state = save(eeprom, variant(12));
    const params::Table found = boot(eeprom);
    if (state == wire::SaveState::saved) {
      EXPECT(same(found, variant(12)));  // the cell happened to hold the right value
    } else {
      EXPECT(state == wire::SaveState::failed);
      EXPECT(same(found, newest));
      ++failures;
    }
  }
  CHECK(failures > 50);
}

TEST_CASE("a repeated request to save does not start over, and a failed save can be tried again") {
  FakeEeprom eeprom;
  Store store(eeprom);
  params::Table loaded;
  store.load(loaded);
  const params::Table table = variant(3);
  store.save(table);
  int polls = 0;
  for (; store.state() == wire::SaveState::saving; ++polls) {
    store.save(table);
    store.poll();
  }
  CHECK(store.state() == wire::SaveState::saved);
  CHECK(polls < 1500);

  eeprom.stuck = bank::start_b + bank::payload_at;
  CHECK(save(store, variant(4)) == wire::SaveState::failed);
  eeprom.stuck = -1;
  CHECK(save(store, variant(4)) == wire::SaveState::saved);
  CHECK(same(boot(eeprom), variant(4)));
}

TEST_CASE("a table that changes while it is being saved is never stored as a mixture") {
  params::Table newest;
  const FakeEeprom before = history(1, newest);
  int stored = 0;
  int refused = 0;
  for (int moment = 0; moment < 1200; ++moment) {
    FakeEeprom eeprom = before;
    Store store(eeprom);
    params::Table loaded;
    store.load(loaded);
    params::Table table = variant(3);
    store.save(table);
    for (int polls = 0; store.state() == wire::SaveState::saving; ++polls) {
      if (polls == moment) table = variant(4);
      store.poll();
    }
    const params::Table found = boot(eeprom);
    if (store.state() == wire::SaveState::saved) {
      EXPECT((same(found, variant(3)) || same(found, variant(4))));
      ++stored;
    } else {
      EXPECT(same(found, newest));
      ++refused;
    }
  }
  CHECK(stored > 0);
  CHECK(refused > 100);
}
