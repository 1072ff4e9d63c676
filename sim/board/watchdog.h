// The watchdog: an interrupt, a reset, or first the one and then the other, after its time without a WDR.
#pragma once

#include <cstdint>

#include "interrupts.h"
#include "mcu.h"

namespace board {

class Watchdog {
 public:
  Watchdog(Mcu& mcu, Interrupts& interrupts);
  // After MCUSR has its flags: while it holds WDRF, the watchdog is on.
  void reset();
  // Its interrupt has been entered.
  void acknowledge();
  // It resets the chip unless a WDR comes in time.
  bool resets() const { return mcu_.data[reg::WDTCSR] & WDE; }

 private:
  uint8_t& control() { return mcu_.data[reg::WDTCSR]; }
  bool on() { return control() & (WDE | WDIE); }
  uint64_t period() const;
  void restart();  // WDR
  void count_from(uint64_t cycle);
  void wait();
  void write_control(uint16_t reg, uint8_t value);
  void on_time_out(uint64_t cycle);
  void on_window_closed(uint64_t cycle);

  enum : uint8_t { WDIF = 0x80, WDIE = 0x40, WDP3 = 0x20, WDCE = 0x10, WDE = 0x08, WDP = 0x07 };

  Mcu& mcu_;
  Interrupts& interrupts_;
  uint64_t counts_from_ = 0;
};

}  // namespace board
