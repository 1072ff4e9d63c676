// Whether what the tick works by is still as it was when a set was applied. A CRC goes over it, part by part, some
// bytes after each tick; a bit that flips in memory is found at the end of the round.
#pragma once
#include <link/crc16.h>
#include <stdint.h>

namespace app {

// Bytes that nobody may change while a set runs.
struct Part {
  const uint8_t* bytes;
  uint8_t size;
};

class MemoryWatch {
 public:
  static constexpr uint8_t bytes_per_look = 8;

  uint8_t part() const { return part_; }  // the one that is next
  void restart() {
    crc_ = wire::Crc16();
    part_ = at_ = 0;
  }
  void add(const Part& part) {
    for (uint8_t count = bytes_per_look; count != 0 && at_ != part.size; --count) crc_.add(part.bytes[at_++]);
    if (at_ != part.size) return;
    at_ = 0;
    ++part_;
  }
  // At the end of a round: what is right from now on, or whether it still is.
  void learn() {
    right_ = crc_.value();
    restart();
  }
  bool ends_well() {
    const bool same = crc_.value() == right_;
    restart();
    return same;
  }

 private:
  wire::Crc16 crc_;
  uint16_t right_ = 0;
  uint8_t part_ = 0, at_ = 0;
};

}  // namespace app
