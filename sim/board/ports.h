// The digital ports: what the program drives, and what something outside holds at a level. Any other input reads its
// pull-up. There are no external and pin-change interrupts.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "chip.h"
#include "mcu.h"

namespace board {

class Ports {
 public:
  Ports(Mcu& mcu, const Chip& chip) : mcu_(mcu) {
    for (const char* letter = chip.ports; *letter; ++letter) {
      const uint16_t pin = port_base(*letter);
      on_read<&Ports::read_pin>(mcu_, pin, *this);
      on_write<&Ports::write_pin>(mcu_, pin, *this);
    }
  }

  static bool exists(const Chip& chip, char letter) { return letter && std::strchr(chip.ports, letter); }

  // The pin is an output and high.
  bool driven_high(uint16_t pin_register, unsigned bit) const {
    return (mcu_.data[pin_register + 1] & mcu_.data[pin_register + 2]) >> bit & 1;
  }

  // Something outside holds a pin at a level until it lets go, through resets and power cuts too. It only matters while
  // the pin is an input.
  void hold(uint16_t pin_register, unsigned bit, bool high) {
    Held& held = held_.at(place(pin_register));
    const auto mask = static_cast<uint8_t>(1u << bit);
    held.mask = static_cast<uint8_t>(held.mask | mask);
    held.levels = static_cast<uint8_t>(high ? held.levels | mask : held.levels & ~mask);
  }
  void let_go(uint16_t pin_register, unsigned bit) {
    Held& held = held_.at(place(pin_register));
    held.mask = static_cast<uint8_t>(held.mask & ~(1u << bit));
  }

 private:
  struct Held {
    uint8_t mask, levels;
  };
  static constexpr size_t port_count = 11;  // A..G and H..L, without I

  static size_t place(uint16_t pin_register) {
    const auto past = static_cast<size_t>(pin_register < port_base('H') ? pin_register - port_base('A')
                                                                        : pin_register - port_base('H') + 3 * 7);
    return past / 3;
  }

  // An output reads what it drives, a free input its pull-up: PORTx in both cases.
  uint8_t read_pin(uint16_t reg) {
    const Held& held = held_[place(reg)];
    const auto outside = static_cast<uint8_t>(held.mask & ~mcu_.data[reg + 1]);
    return static_cast<uint8_t>((mcu_.data[reg + 2] & ~outside) | (held.levels & outside));
  }
  void write_pin(uint16_t reg, uint8_t value) { mcu_.data[reg + 2] ^= bits_written(mcu_, value); }

  Mcu& mcu_;
  std::array<Held, port_count> held_{};
};

}  // namespace board
