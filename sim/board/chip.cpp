// The two chips of the supported boards: Arduino Mega 2560 and Arduino Nano.
#include "chip.h"

#include "error.h"

namespace board {

namespace {
// clang-format off
// Number, 16 bits, TCCRnA, vector of compare match A, channels with their pins.
constexpr TimerMap mega_timers[] = {
    {0, false, 0x44, 21, 2, {{'B', 7}, {'G', 5}, {}}},
    {1, true, 0x80, 17, 3, {{'B', 5}, {'B', 6}, {'B', 7}}},
    {2, false, 0xB0, 13, 2, {{'B', 4}, {'H', 6}, {}}},
    {3, true, 0x90, 32, 3, {{'E', 3}, {'E', 4}, {'E', 5}}},
    {4, true, 0xA0, 42, 3, {{'H', 3}, {'H', 4}, {'H', 5}}},
    {5, true, 0x120, 47, 3, {{'L', 3}, {'L', 4}, {'L', 5}}},
};
constexpr TimerMap nano_timers[] = {
    {0, false, 0x44, 14, 2, {{'D', 6}, {'D', 5}, {}}},
    {1, true, 0x80, 11, 2, {{'B', 1}, {'B', 2}, {}}},
    {2, false, 0xB0, 7, 2, {{'B', 3}, {'D', 3}, {}}},
};

// In the order of the struct: names and architecture; cycles; flash; RAM and EEPROM; what is wide; ports; vectors; timers.
constexpr Chip chips[] = {
    {"atmega2560", "ATmega2560", 6, 5, 5, 0x40000, 0x3E000, 256, 0x200, 0x21FF, 4096, true, true,
     "ABCDEFGHJKL", 'F', 0xFF, 12, 25, 29, 30, mega_timers, 6},
    {"atmega328p", "ATmega328P", 5, 4, 4, 0x8000, 0x7000, 128, 0x100, 0x8FF, 1024, false, false,
     "BCD", 'C', 0x3F, 6, 18, 21, 22, nano_timers, 3},
};
// clang-format on
}  // namespace

const Chip& find_chip(const std::string& name) {
  for (const Chip& chip : chips)
    if (name == chip.name) return chip;
  throw BoardError("the chip \"" + name + "\" is not simulated; use atmega2560 or atmega328p");
}

}  // namespace board
