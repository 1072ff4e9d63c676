// The CPU: executes instructions that are decoded once.
#pragma once

#include <cstdint>
#include <vector>

#include "chip.h"
#include "instruction.h"
#include "mcu.h"

namespace board {

class Cpu {
 public:
  explicit Cpu(Mcu& mcu);

  // Executes at least one instruction, and on until the next event is due, an interrupt wants attention, or the CPU
  // sleeps or crashes.
  void run();

  // Forgets what was decoded there.
  void flash_changed(uint32_t address, uint32_t count);

 private:
  struct State;

  Mcu& mcu_;
  Decoder decoder_;
  uint32_t mask_;  // word addresses wrap
  bool wide_pc_;
  std::vector<Instruction> decoded_;
};

}  // namespace board
