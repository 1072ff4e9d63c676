// SPDX-License-Identifier: GPL-3.0-or-later
// libsimavr's C headers, and the few words of glue every peripheral model here needs: I/O hooks and timed events.
#pragma once

#include <cstdint>
#include <string>

extern "C" {
#include <simavr/avr_eeprom.h>
#include <simavr/avr_timer.h>
#include <simavr/avr_uart.h>
#include <simavr/avr_watchdog.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_core.h>
#include <simavr/sim_irq.h>
}

namespace board {

class Flash;

// What simavr's callbacks without user data find their board by: avr.custom.data points to one.
struct Hooks {
  Flash* flash = nullptr;
  std::string last_error;
};

inline Hooks& hooks_of(avr_t& avr) { return *static_cast<Hooks*>(avr.custom.data); }

// Calls model.*Method(reg, value) when the program writes the register. The method stores the value itself.
template <auto Method, class Model>
void on_write(avr_t& avr, uint16_t reg, Model& model) {
  auto& hook = avr.io[AVR_DATA_TO_IO(reg)].w;
  hook.param = &model;
  hook.c = [](avr_t*, avr_io_addr_t address, uint8_t value, void* self) {
    (static_cast<Model*>(self)->*Method)(address, value);
  };
}

// Calls model.*Method(reg) when the program reads the register; what it returns is what the program sees.
template <auto Method, class Model>
void on_read(avr_t& avr, uint16_t reg, Model& model) {
  auto& hook = avr.io[AVR_DATA_TO_IO(reg)].r;
  hook.param = &model;
  hook.c = [](avr_t*, avr_io_addr_t address, void* self) { return (static_cast<Model*>(self)->*Method)(address); };
}

// The register is plain memory, whatever simavr had in mind for it.
inline void plain_register(avr_t& avr, uint16_t reg) {
  avr.io[AVR_DATA_TO_IO(reg)].r = {nullptr, nullptr};
  avr.io[AVR_DATA_TO_IO(reg)].w = {nullptr, nullptr};
}

template <auto Method, class Model>
avr_cycle_count_t event_handler(avr_t*, avr_cycle_count_t when, void* self) {
  return (static_cast<Model*>(self)->*Method)(when);
}

// Calls model.*Method(cycle) at the given cycle; it returns the cycle of the next call, or 0 for none.
// Scheduling the same method again moves the event.
template <auto Method, class Model>
void schedule(avr_t& avr, uint64_t cycle, Model& model) {
  avr_cycle_timer_register(&avr, cycle > avr.cycle ? cycle - avr.cycle : 0, &event_handler<Method, Model>, &model);
}

template <auto Method, class Model>
void cancel(avr_t& avr, Model& model) {
  avr_cycle_timer_cancel(&avr, &event_handler<Method, Model>, &model);
}

// Inside a register hook: the cycle at which the running store instruction ends. simavr calls the hook at its start.
inline uint64_t store_ends(const avr_t& avr) {
  const unsigned opcode = static_cast<unsigned>(avr.flash[avr.pc] | avr.flash[avr.pc + 1] << 8);
  const bool is_out = (opcode & 0xF800u) == 0xB800u;
  return avr.cycle + (is_out ? 1u : 2u);
}

// Inside a hook of a write-one-to-act register below 0x40: the bits the program meant. simavr turns SBI into
// read-modify-write, but the chip acts on the one bit only.
inline uint8_t bits_written(const avr_t& avr, uint8_t value) {
  const unsigned opcode = static_cast<unsigned>(avr.flash[avr.pc] | avr.flash[avr.pc + 1] << 8);
  const bool is_sbi = (opcode & 0xFF00u) == 0x9A00u;
  return is_sbi ? static_cast<uint8_t>(1u << (opcode & 7u)) : value;
}

// The CPU stands still for some cycles (EEPROM access, interrupt entry, ...); events due meanwhile are not late.
inline void stall(avr_t& avr, uint64_t cycles) {
  avr.cycle += cycles;
  avr.run_cycle_count = avr.run_cycle_count > cycles ? avr.run_cycle_count - cycles : 1;
}

}  // namespace board
