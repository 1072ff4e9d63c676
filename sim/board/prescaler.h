// SPDX-License-Identifier: GPL-3.0-or-later
// GTCCR: clears the counters of the prescalers, one shared by all timers but timer 2, which has its own.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "chip.h"
#include "simavr.h"
#include "timer.h"

namespace board {

class Prescaler {
 public:
  Prescaler(avr_t& avr, std::vector<Timer*> timers) : avr_(avr), timers_(std::move(timers)) {
    plain_register(avr_, reg::GTCCR);
    on_write<&Prescaler::write_control>(avr_, reg::GTCCR, *this);
  }

 private:
  enum : uint8_t { TSM = 0x80, PSRASY = 0x02, PSRSYNC = 0x01 };

  // The bits clear themselves. Holding the timers with TSM is not modelled.
  void write_control(uint16_t reg, uint8_t value) {
    avr_.data[reg] = value & TSM;
    for (Timer* timer : timers_)
      if (value & (timer->number() == 2 ? PSRASY : PSRSYNC)) timer->restart_prescaler();
  }

  avr_t& avr_;
  std::vector<Timer*> timers_;
};

}  // namespace board
