// SPDX-License-Identifier: GPL-3.0-or-later
// Program files: Intel HEX and ELF, read into pieces of memory. Errors name file, line or field, and remedy.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace board {

struct Segment {
  uint32_t address = 0;
  std::vector<uint8_t> bytes;
};

struct ElfImage {
  unsigned architecture = 0;      // EF_AVR_MACH: 5 for the ATmega328P, 6 for the ATmega2560
  std::vector<Segment> segments;  // what is loaded, by physical address
};

std::vector<Segment> read_intel_hex(const std::string& path);
ElfImage read_elf(const std::string& path);

}  // namespace board
