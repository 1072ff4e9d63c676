// GTCCR: clears the counters of the prescalers, one shared by all timers but timer 2, which has its own.
#pragma once

#include <cstdint>
#include <deque>

#include "chip.h"
#include "mcu.h"
#include "timer.h"

namespace board {

class Prescaler {
 public:
  Prescaler(Mcu& mcu, std::deque<Timer>& timers) : mcu_(mcu), timers_(timers) {
    on_write<&Prescaler::write_control>(mcu_, reg::GTCCR, *this);
  }

 private:
  enum : uint8_t { TSM = 0x80, PSRASY = 0x02, PSRSYNC = 0x01 };

  // The bits clear themselves. Holding the timers with TSM is not modelled.
  void write_control(uint16_t reg, uint8_t value) {
    mcu_.data[reg] = value & TSM;
    for (Timer& timer : timers_)
      if (value & (timer.number() == 2 ? PSRASY : PSRSYNC)) timer.restart_prescaler();
  }

  Mcu& mcu_;
  std::deque<Timer>& timers_;
};

}  // namespace board
