// An EEPROM in memory that is busy after each write, counts wear, refuses misuse, and can lose power in a write.
#pragma once

#include <stdint.h>

#include <stdexcept>
#include <vector>

struct PowerCut {};

class FakeEeprom {
 public:
  static constexpr int size = 1024;
  static constexpr int busy_polls = 3;
  static constexpr int untouched = -1;

  FakeEeprom() : cells(size, 0xFF), wear(size, 0) {}

  uint8_t read(uint16_t address) const {
    if (busy_ > 0) throw std::logic_error("read while busy");
    return cells.at(address);
  }

  void begin_write(uint16_t address, uint8_t byte) {
    if (busy_ > 0) throw std::logic_error("write while busy");
    ++wear.at(address);
    ++writes;
    if (writes == cut_at) {
      if (torn != untouched) cells.at(address) = static_cast<uint8_t>(torn);
      throw PowerCut();
    }
    cells.at(address) = stuck == address ? cells.at(address) : byte;
    busy_ = busy_polls;
  }

  bool busy() {
    if (busy_ > 0) --busy_;
    return busy_ > 0;
  }

  void power_on() {
    busy_ = 0;
    writes = 0;
    cut_at = 0;
  }

  std::vector<uint8_t> cells;
  std::vector<int> wear;
  int writes = 0;
  int cut_at = 0;   // the write, counted from 1, in which the power goes; 0 never
  int torn = 0xFF;  // what the cell has become when the power went
  int stuck = -1;   // a worn-out cell that keeps its value

 private:
  int busy_ = 0;
};
