// Self-programming (SPM) as a bootloader needs it: page buffer, erase and write times, the section that stays readable.
#pragma once

#include <cstdint>
#include <vector>

#include "chip.h"
#include "cpu.h"
#include "mcu.h"
#include "trace.h"

namespace board {

class Flash {
 public:
  Flash(Mcu& mcu, const Chip& chip, Cpu& cpu, Trace& trace);
  void reset();
  // From here up nothing is written: the boot lock bits of an Arduino.
  void protect_from(uint32_t address) { protected_from_ = address; }
  uint64_t page_writes() const { return page_writes_; }

 private:
  void store_program_memory();
  void fill_buffer(uint32_t address);
  void program_page(uint32_t address, bool erase);
  void clear_buffer();
  void write_control(uint16_t reg, uint8_t value);
  void on_window_closed(uint64_t when);
  void on_done(uint64_t when);

  Mcu& mcu_;
  const Chip& chip_;
  Cpu& cpu_;
  Trace& trace_;
  std::vector<uint8_t> buffer_;
  std::vector<bool> filled_;  // one a word
  uint32_t protected_from_ = UINT32_MAX;
  bool busy_ = false;
  uint64_t page_writes_ = 0;
};

}  // namespace board
