// SPDX-License-Identifier: GPL-3.0-or-later
// The two chips of the supported boards: Arduino Mega 2560 and Arduino Nano.
#include "chip.h"

#include "error.h"

namespace board {

namespace {
constexpr Chip chips[] = {
    {"atmega2560", "ATmega2560", 6, 5, 5, 0x3E000, 256, true, true, "ABCDEFGHJKL", 'F', 0xFF},
    {"atmega328p", "ATmega328P", 5, 4, 4, 0x7000, 128, false, false, "BCD", 'C', 0x3F},
};
}  // namespace

const Chip& find_chip(const std::string& name) {
  for (const Chip& chip : chips)
    if (name == chip.name) return chip;
  throw BoardError("the chip \"" + name + "\" is not simulated; use atmega2560 or atmega328p");
}

}  // namespace board
