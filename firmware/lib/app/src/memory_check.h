// Checks that the bytes which a set has become are still as they were when it was applied. A CRC goes over them, part
// by part, some bytes after each tick. A bit that has flipped in memory is found at the end of the round.
#pragma once
#include <link/crc16.h>
#include <stdint.h>

namespace app {

// Bytes that nobody may change while a set runs.
struct Part {
  const uint8_t* bytes;
  uint8_t size;
};

class MemoryCheck {
 public:
  static constexpr uint8_t bytes_per_tick = 8;

  uint8_t part() const { return part_; }  // the number of the next one; at the end of a round that of none
  void restart() {
    crc_ = wire::Crc16();
    part_ = at_ = 0;
  }
  void add(const Part& part) {
    for (uint8_t count = bytes_per_tick; count != 0 && at_ != part.size; --count) crc_.add(part.bytes[at_++]);
    if (at_ != part.size) return;
    at_ = 0;
    ++part_;
  }
  // At the end of a round: this one's CRC is the right one from now on.
  void learn() {
    right_ = crc_.value();
    restart();
  }
  // At the end of a round: its CRC is the right one.
  bool ends_well() {
    const bool same = crc_.value() == right_;
    restart();
    return same;
  }

 private:
  wire::Crc16 crc_{0};  // until restart()
  uint16_t right_ = 0;
  uint8_t part_ = 0, at_ = 0;
};

}  // namespace app
