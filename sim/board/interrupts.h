// SPDX-License-Identifier: GPL-3.0-or-later
// Interrupt requests of the models, what entering an interrupt costs, and how long the handlers take.
#pragma once

#include <array>
#include <cstdint>

#include "chip.h"
#include "simavr.h"
#include "trace.h"

namespace board {

struct HandlerTimes {
  uint64_t count = 0;
  uint64_t cycles = 0;  // all runs together, entry and RETI included
  uint64_t shortest = UINT64_MAX;
  uint64_t longest = 0;
};

class Interrupts {
 public:
  static constexpr unsigned vector_count = 64;

  Interrupts(avr_t& avr, const Chip& chip, Trace& trace);

  // An event: sets the flag, and makes the interrupt pending when it is enabled.
  void raise(avr_int_vector_t& vector);
  // A level: pending as long as it is asserted and enabled.
  void set_level(avr_int_vector_t& vector, bool asserted);
  static void withdraw(avr_int_vector_t& vector) { vector.pending = 0; }

  // Enters a pending interrupt, if the CPU accepts one after this instruction. True if it did.
  bool service(bool woken);
  void reset();

  const HandlerTimes& times(unsigned vector) const { return slots_[vector].times; }
  uint64_t entered() const { return entered_; }

 private:
  struct Slot {
    Interrupts* owner = nullptr;
    uint8_t vector = 0;
    uint64_t entered_at = 0;
    bool running = false;
    HandlerTimes times;
  };
  static void on_running(avr_irq_t*, uint32_t running, void* slot);
  bool queued(const avr_int_vector_t& vector) const;

  avr_t& avr_;
  const Chip& chip_;
  Trace& trace_;
  std::array<Slot, vector_count> slots_;
  uint64_t entered_ = 0;
};

}  // namespace board
