// Potentiometers at a rail: a single reading may be noise, a broken wire is told, and so is one that comes and goes.
// Pure, and little work while no reading is at a rail.
//
// A tick at a rail fills the pot's bucket by 16, and the bucket leaks 1 in each tick. The third tick in a row makes the
// pot a bad one, and so does any that is at a rail more often than once in 16 ms. It is a good one again some 20 to 50
// ms after its last reading at a rail.
#pragma once
#include <stdint.h>

namespace supervisor {

class Rails {
 public:
  static constexpr uint8_t pot_count = 8;

  // A tick has seen these pots at a rail; at least one.
  __attribute__((noinline)) void fill(uint8_t low, uint8_t high) {
    const uint8_t any = low | high;
    for (uint8_t pot = 0, mask = 1; pot < pot_count; ++pot, mask = static_cast<uint8_t>(mask << 1)) {
      if (!(any & mask)) continue;
      const auto level = static_cast<uint8_t>(level_[pot] + tick_at_rail);
      level_[pot] = level > full ? full : level;
      if (level <= good) continue;
      if (low & mask) bad_low_ |= mask;
      else bad_low_ &= static_cast<uint8_t>(~mask);
      if (high & mask) bad_high_ |= mask;
      else bad_high_ &= static_cast<uint8_t>(~mask);
    }
  }
  // What four ticks leak, of the two pots of a joint.
  void leak(uint8_t joint) {
    leak_pot(joint);
    leak_pot(static_cast<uint8_t>(joint + pot_count / 2));
  }

  // Bit i is pot i.
  uint8_t bad_low() const { return bad_low_; }
  uint8_t bad_high() const { return bad_high_; }

 private:
  static constexpr uint8_t tick_at_rail = 16, good = 40, full = 64, leaks = 4;

  void leak_pot(uint8_t pot) {
    if (level_[pot] == 0) return;
    level_[pot] = static_cast<uint8_t>(level_[pot] - leaks);
    if (level_[pot] > good) return;
    const auto others = static_cast<uint8_t>(~(1u << pot));
    bad_low_ &= others;
    bad_high_ &= others;
  }

  uint8_t level_[pot_count] = {};  // multiples of leaks
  uint8_t bad_low_ = 0, bad_high_ = 0;
};

}  // namespace supervisor
