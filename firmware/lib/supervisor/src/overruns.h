// Bytes that the receiver lost: a few are ridden through, a flood of bytes is told. Pure, and no work while nothing is
// lost.
//
// A tick in which bytes were lost is a lossy one. It fills a bucket by 128, and the bucket leaks 1 in each tick. The
// fourth lossy tick in a row makes a flood, and so does any loss that goes on with less than 128 ms from one lossy tick
// to the next.
//
// No honest host comes near. It waits for the answer to a request before it sends another. Without waiting it sends
// points of a reference, at most 12 x 11 bytes in 192 ms, and a renewal of 8. These 140 bytes take 1.4 ms on the wire.
// The receiver holds 129 (127 in its ring and two in the chip), and the board takes 20 more in each tick, however busy
// it is. So such a host loses nothing.
#pragma once
#include <stdint.h>

namespace supervisor {

class Overruns {
 public:
  void forget() { level_ = 0; }
  // Bytes were lost in this tick. True when that is a flood.
  bool lost(uint16_t tick) {
    const auto since = static_cast<uint16_t>(tick - last_);
    if (level_ != 0 && since == 0) return false;  // this tick has been counted
    last_ = tick;
    level_ = static_cast<uint16_t>((since < level_ ? level_ - since : 0) + lossy_tick);
    return level_ > flood;
  }

 private:
  static constexpr uint16_t lossy_tick = 128, flood = 3 * lossy_tick;

  uint16_t level_ = 0;
  uint16_t last_ = 0;  // lossy tick
};

}  // namespace supervisor
