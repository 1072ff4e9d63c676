// SPDX-License-Identifier: GPL-3.0-or-later
// Interrupts over simavr's vector table. simavr keeps the requests and picks the vector; entry takes it no time, so the
// cycles of the data sheet are added here (section "Interrupt Response Time": 4 cycles, 5 with a 22-bit program
// counter, and as many again when the CPU was asleep).
#include "interrupts.h"

#include <algorithm>

namespace board {

Interrupts::Interrupts(avr_t& avr, const Chip& chip, Trace& trace) : avr_(avr), chip_(chip), trace_(trace) {
  for (unsigned i = 0; i < avr.interrupts.vector_count; ++i) {
    avr_int_vector_t& vector = *avr.interrupts.vector[i];
    Slot& slot = slots_[vector.vector];
    slot.owner = this;
    slot.vector = vector.vector;
    avr_irq_register_notify(vector.irq + AVR_INT_IRQ_RUNNING, &Interrupts::on_running, &slot);
  }
}

void Interrupts::reset() {
  for (Slot& slot : slots_) slot.running = false;
}

// simavr calls this with 1 when it has jumped to the vector, and with 0 at the start of RETI.
void Interrupts::on_running(avr_irq_t*, uint32_t running, void* data) {
  Slot& slot = *static_cast<Slot*>(data);
  Interrupts& self = *slot.owner;
  if (running) {
    slot.entered_at = self.avr_.cycle;
    slot.running = true;
    ++self.entered_;
    self.trace_.add(Trace::Kind::interrupt, self.avr_.cycle, slot.vector);
  } else if (slot.running) {
    slot.running = false;
    const uint64_t cycles = self.avr_.cycle + self.chip_.reti - slot.entered_at;
    HandlerTimes& times = slot.times;
    ++times.count;
    times.cycles += cycles;
    times.shortest = std::min(times.shortest, cycles);
    times.longest = std::max(times.longest, cycles);
  }
}

// Withdrawn requests stay in simavr's queue until it looks at them; queueing one twice would overflow it in the end.
bool Interrupts::queued(const avr_int_vector_t& vector) const {
  const avr_int_pending_t& queue = avr_.interrupts.pending;
  for (unsigned i = queue.read; i != queue.write; i = (i + 1) % avr_int_pending_fifo_size)
    if (queue.buffer[i] == &vector) return true;
  return false;
}

void Interrupts::raise(avr_int_vector_t& vector) {
  if (vector.pending) return;
  if (!queued(vector)) {
    avr_raise_interrupt(&avr_, &vector);
    return;
  }
  avr_regbit_set(&avr_, vector.raised);
  if (!avr_regbit_get(&avr_, vector.enable)) return;
  vector.pending = 1;
  if (avr_.sreg[S_I] && avr_.interrupt_state == 0) avr_.interrupt_state = 1;
  if (avr_.state == cpu_Sleeping) avr_.state = cpu_Running;
}

void Interrupts::set_level(avr_int_vector_t& vector, bool asserted) {
  if (asserted) raise(vector);
  else withdraw(vector);
}

bool Interrupts::service(bool woken) {
  // simavr lets two instructions run after SEI or RETI, the chip one: ask again when the wait has just ended.
  const bool wait_ends = avr_.interrupt_state == -1;
  const uint64_t before = entered_;
  avr_service_interrupts(&avr_);
  if (wait_ends && avr_.interrupt_state > 0) avr_service_interrupts(&avr_);
  if (entered_ == before) return false;
  stall(avr_, woken ? 2 * chip_.interrupt_entry : chip_.interrupt_entry);
  return true;
}

}  // namespace board
