// Interrupts after the data sheets, sections "Reset and Interrupt Handling" and "Interrupt Response Time": the lowest
// vector goes first; entry takes 4 cycles, 5 with a 22-bit program counter, and as many again when the CPU was asleep.
#include "interrupts.h"

#include <algorithm>

namespace board {

namespace {
constexpr uint32_t vector_bytes = 4;
}

Interrupts::Interrupts(Mcu& mcu, Trace& trace) : mcu_(mcu), trace_(trace) {
  mcu_.reti = action<&Interrupts::leave>(*this);
}

void Interrupts::raise(unsigned vector) {
  const Source& source = slots_[vector].source;
  mcu_.data[source.flag_reg] |= source.flag_bit;
  if (!enabled(source)) return;
  mcu_.pending |= uint64_t{1} << vector;
  if (mcu_.state == Mcu::State::asleep && mcu_.flags[flag::I]) mcu_.state = Mcu::State::running;
}

void Interrupts::set_level(unsigned vector, bool asserted) {
  if (asserted) raise(vector);
  else withdraw(vector);
}

unsigned Interrupts::service(bool woken) {
  if (!mcu_.flags[flag::I] || !mcu_.pending) return 0;
  const auto vector = static_cast<unsigned>(__builtin_ctzll(mcu_.pending));
  const Source& source = slots_[vector].source;
  if (vector == 0 || !enabled(source)) {  // one more instruction; or somebody outside has changed the register
    withdraw(vector);
    return 0;
  }
  if (source.flag_bit) {
    mcu_.data[source.flag_reg] &= static_cast<uint8_t>(~source.flag_bit);
    withdraw(vector);
  }
  mcu_.push_address(mcu_.pc);
  mcu_.set_interrupt_flag(false);
  mcu_.pc = vector * vector_bytes;
  trace_.add(Trace::Kind::interrupt, mcu_.cycle, vector);
  if (depth_ < running_.size()) running_[depth_++] = {vector, mcu_.cycle};
  ++entered_;
  mcu_.cycle += mcu_.chip.interrupt_entry * (woken ? 2u : 1u);
  return vector;
}

// At the start of RETI.
void Interrupts::leave() {
  if (depth_ == 0) return;
  const Running& left = running_[--depth_];
  const uint64_t cycles = mcu_.cycle + mcu_.chip.reti - left.since;
  HandlerTimes& times = slots_[left.vector].times;
  ++times.count;
  times.cycles += cycles;
  times.shortest = std::min(times.shortest, cycles);
  times.longest = std::max(times.longest, cycles);
}

}  // namespace board
