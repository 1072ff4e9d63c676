// SPDX-License-Identifier: GPL-3.0-or-later
// The digital ports: what the program drives. Nothing outside drives a pin, so inputs read their pull-up, and there are
// no external and pin-change interrupts; simavr's own model would signal eight listeners on every write.
#pragma once

#include <cstdint>
#include <cstring>

#include "chip.h"
#include "simavr.h"

namespace board {

class Ports {
 public:
  Ports(avr_t& avr, const Chip& chip) : avr_(avr) {
    for (const char* letter = chip.ports; *letter; ++letter) {
      const uint16_t pin = port_base(*letter);
      for (uint16_t reg = pin; reg < pin + 3; ++reg) plain_register(avr_, reg);
      on_read<&Ports::read_pin>(avr_, pin, *this);
      on_write<&Ports::write_pin>(avr_, pin, *this);
    }
  }

  static bool exists(const Chip& chip, char letter) { return letter && std::strchr(chip.ports, letter); }

  // The pin is an output and high.
  bool driven_high(uint16_t pin_register, unsigned bit) const {
    return (avr_.data[pin_register + 1] & avr_.data[pin_register + 2]) >> bit & 1;
  }

 private:
  // An output reads what it drives, an input its pull-up: PORTx in both cases.
  uint8_t read_pin(uint16_t reg) { return avr_.data[reg + 2]; }
  void write_pin(uint16_t reg, uint8_t value) { avr_.data[reg + 2] ^= bits_written(avr_, value); }

  avr_t& avr_;
};

}  // namespace board
