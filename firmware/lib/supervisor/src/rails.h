// Potentiometers at a rail: a single reading may be noise, a broken wire is told, and so is one that comes and goes.
// Pure, and little work while no reading is at a rail.
//
// A tick at a rail fills the pot's bucket by 16, and the bucket leaks 1 in each tick. The third tick in a row makes the
// pot a bad one, and so does any that is at a rail more often than once in 16 ms. It is a good one again some 20 to 50
// ms after its last reading at a rail.
//
// The buckets hold quarters of that, 0..16, and leak one in four ticks. Byte n has bit n of all eight of them, so that
// all pots are counted at once, in the same few cycles however many are at a rail.
#pragma once
#include <stdint.h>

namespace supervisor {

class Rails {
 public:
  // A tick has seen these pots at a rail; at least one. The most is 16: then all other bits are 0.
#ifdef __AVR__
  // A clone for the one object that there is would be twice as slow: each byte's address would have its own registers.
  __attribute__((noinline, noclone))
#endif
  void fill(uint8_t low, uint8_t high) {
    const uint8_t any = low | high;
    const uint8_t eight_more = any & level_[2];
    const uint8_t full = level_[4] | (eight_more & level_[3]);
    const auto others = static_cast<uint8_t>(~full);
    const uint8_t ones = level_[0] & others, twos = level_[1] & others;
    const uint8_t fours = (level_[2] ^ any) & others, eights = (level_[3] ^ eight_more) & others;
    level_[0] = ones;
    level_[1] = twos;
    level_[2] = fours;
    level_[3] = eights;
    level_[4] = full;
    const uint8_t bad = any & above_good(ones, twos, fours, eights, full);
    bad_low_ = static_cast<uint8_t>((bad_low_ & ~bad) | (low & bad));
    bad_high_ = static_cast<uint8_t>((bad_high_ & ~bad) | (high & bad));
  }
  // What four ticks leak, of the two pots of a joint.
  void leak(uint8_t joint) {
    uint8_t any = 0;
    for (const uint8_t bits : level_) any |= bits;
    const auto filled = static_cast<uint8_t>(any & (0x11u << joint));
    uint8_t borrowed = filled;
    for (uint8_t& bits : level_) {
      bits ^= borrowed;
      borrowed &= bits;
    }
    const auto others =
        static_cast<uint8_t>(~filled | above_good(level_[0], level_[1], level_[2], level_[3], level_[4]));
    bad_low_ &= others;
    bad_high_ &= others;
  }

  // Bit i is pot i.
  uint8_t bad_low() const { return bad_low_; }
  uint8_t bad_high() const { return bad_high_; }

 private:
  // Above 10: 11..15 and 16.
  static uint8_t above_good(uint8_t ones, uint8_t twos, uint8_t fours, uint8_t eights, uint8_t full) {
    return full | (eights & (fours | (twos & ones)));
  }

  uint8_t level_[5] = {};
  uint8_t bad_low_ = 0, bad_high_ = 0;
};

}  // namespace supervisor
