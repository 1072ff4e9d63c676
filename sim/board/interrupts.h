// The interrupt table: requests of the models, which goes first, what entering it costs, how long the handlers take.
#pragma once

#include <array>
#include <cstdint>

#include "mcu.h"
#include "trace.h"

namespace board {

struct HandlerTimes {
  uint64_t count = 0;
  uint64_t cycles = 0;  // all runs together, entry and RETI included
  uint64_t shortest = UINT64_MAX;
  uint64_t longest = 0;
};

// What lets a request through, and the flag that says there is one. A source without a flag requests for as long as
// its cause lasts; of any other, entering the interrupt clears the flag.
struct Source {
  uint16_t enable_reg = 0;
  uint8_t enable_bit = 0;
  uint16_t flag_reg = 0;
  uint8_t flag_bit = 0;
};

class Interrupts {
 public:
  static constexpr unsigned vector_count = 64;

  Interrupts(Mcu& mcu, Trace& trace);
  void connect(unsigned vector, const Source& source) { slots_[vector].source = source; }

  // An event: sets the flag, and makes the interrupt pending when it is enabled.
  void raise(unsigned vector);
  // A level: pending as long as it is asserted and enabled.
  void set_level(unsigned vector, bool asserted);
  void withdraw(unsigned vector) { mcu_.pending &= ~(uint64_t{1} << vector); }

  // Enters a pending interrupt, if the CPU accepts one after this instruction. Its vector, or 0.
  unsigned service(bool woken);
  void reset() { depth_ = 0; }

  const HandlerTimes& times(unsigned vector) const { return slots_[vector].times; }
  uint64_t entered() const { return entered_; }

 private:
  struct Slot {
    Source source;
    HandlerTimes times;
  };
  struct Running {
    unsigned vector;
    uint64_t since;
  };
  bool enabled(const Source& source) const { return mcu_.data[source.enable_reg] & source.enable_bit; }
  void leave();  // RETI

  Mcu& mcu_;
  Trace& trace_;
  std::array<Slot, vector_count> slots_;
  std::array<Running, vector_count> running_;  // the innermost last; deeper ones are not timed
  size_t depth_ = 0;
  uint64_t entered_ = 0;
};

}  // namespace board
