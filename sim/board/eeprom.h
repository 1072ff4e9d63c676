// The EEPROM with the time a write takes, and with what is left of a byte when the power fails meanwhile.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "interrupts.h"
#include "mcu.h"
#include "trace.h"

namespace board {

class Eeprom {
 public:
  Eeprom(Mcu& mcu, Interrupts& interrupts, Trace& trace);
  // A reset does not stop a write under way; losing power does.
  void reset();
  void lose_power(uint64_t seed);

  std::string content() const;
  void set_content(const std::string& bytes);
  uint64_t writes() const { return writes_; }

 private:
  enum class Mode : uint8_t { erase_and_write = 0, erase = 1, write = 2, reserved = 3 };

  uint8_t& control() { return mcu_.data[reg::EECR]; }
  uint16_t address() const;
  uint64_t busy_cycles(Mode mode) const;
  void on_done(uint64_t when);
  void on_window_closed(uint64_t when);
  void refresh_interrupt();
  void write_control(uint16_t reg, uint8_t value);

  Mcu& mcu_;
  Interrupts& interrupts_;
  Trace& trace_;

  std::vector<uint8_t> cells_;
  bool busy_ = false;
  uint64_t begin_ = 0;
  uint64_t end_ = 0;
  Mode mode_ = Mode::erase_and_write;
  uint16_t cell_ = 0;
  uint8_t byte_ = 0;
  uint64_t writes_ = 0;
};

}  // namespace board
