// SPDX-License-Identifier: GPL-3.0-or-later
// The CPU: executes decoded instructions on simavr's state, several times as fast as simavr's own decoder.
#pragma once

#include <cstdint>
#include <vector>

#include "chip.h"
#include "instruction.h"
#include "simavr.h"

namespace board {

class Cpu {
 public:
  Cpu(avr_t& avr, const Chip& chip);

  // Like simavr's avr_run_one(): executes until the next event is due, an interrupt wants attention, or the CPU
  // sleeps or crashes. Returns where the program goes on (a byte address).
  avr_flashaddr_t run();

  // Forgets what was decoded there.
  void flash_changed(uint32_t address, uint32_t count);

 private:
  struct State;

  // Everything but plain RAM: registers with their hooks, SREG, addresses that do not exist.
  uint8_t read_register(uint32_t address);
  void write_register(uint32_t address, uint8_t value);
  void crash(const char* what, uint32_t value);

  avr_t& avr_;
  Decoder decoder_;
  uint32_t mask_;  // word addresses wrap
  bool wide_pc_;
  std::vector<Instruction> decoded_;
};

}  // namespace board
