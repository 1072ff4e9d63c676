// The buckets of all pots together count as eight buckets counted one by one.
#include <doctest/doctest.h>
#include <rails.h>

#include <algorithm>
#include <cstdint>
#include <random>

using supervisor::Rails;

namespace {

// The same in words: a tick at a rail fills by 16, four ticks leak 4, and above 40 of 64 a pot is a bad one.
struct Bucket {
  int level = 0;
  bool low = false, high = false;

  void fill(bool at_low, bool at_high) {
    level = std::min(level + 16, 64);
    if (level <= 40) return;
    low = at_low;
    high = at_high;
  }
  void leak() {
    level = std::max(level - 4, 0);
    if (level <= 40) low = high = false;
  }
};

}  // namespace

TEST_CASE("eight buckets fill and leak as one by one, whatever is at a rail") {
  std::mt19937 random(11);
  Rails rails;
  Bucket buckets[8];
  int wrong = 0, bad = 0, good_again = 0;
  for (int tick = 0; tick < 200000; ++tick) {
    const bool busy = (tick >> 6) & 1;  // much is at a rail, then little, so that buckets run full and empty
    auto low = static_cast<std::uint8_t>(random() & random());
    auto high = static_cast<std::uint8_t>(random() & random());
    if (!busy || tick % 3 == 0) low = high = static_cast<std::uint8_t>(random() & random() & random() & random());
    const std::uint8_t before = rails.bad_low() | rails.bad_high();
    if (low | high) rails.fill(low, high);
    const int joint = tick & 3;
    rails.leak(static_cast<std::uint8_t>(joint));
    for (int pot = 0; pot < 8; ++pot) {
      Bucket& bucket = buckets[pot];
      const bool at_low = (low >> pot) & 1, at_high = (high >> pot) & 1;
      if (at_low || at_high) bucket.fill(at_low, at_high);
      if (pot % 4 == joint) bucket.leak();
      wrong += bucket.low != bool((rails.bad_low() >> pot) & 1) || bucket.high != bool((rails.bad_high() >> pot) & 1);
    }
    const std::uint8_t now = rails.bad_low() | rails.bad_high();
    bad += (now & ~before) != 0;
    good_again += (before & ~now) != 0;
  }
  CHECK(wrong == 0);
  CHECK(bad > 1000);
  CHECK(good_again > 1000);
}
