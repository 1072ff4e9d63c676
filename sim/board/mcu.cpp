// Data memory with its registers, the status flags, and what a reset makes of them.
#include "mcu.h"

#include <algorithm>
#include <cstdio>

namespace board {

namespace {

// Registers of peripherals without a model here are plain memory, but start as the data sheets say.
struct InitialValue {
  uint16_t reg;
  uint8_t value;
};
constexpr InitialValue initial_values[] = {
    {0xB9, 0xF8},                                              // TWSR
    {0xBA, 0xFE},                                              // TWAR
    {0xBB, 0xFF},                                              // TWDR
    {0xC8, 0x20},  {0xCA, 0x06},  {0xD0, 0x20}, {0xD2, 0x06},  // UCSR1A, UCSR1C, UCSR2A, UCSR2C
    {0x130, 0x20}, {0x132, 0x06},                              // UCSR3A, UCSR3C
};
constexpr uint16_t usart1 = 0xC8;  // and what is behind it exists on the larger chip only

}  // namespace

Mcu::Mcu(const Chip& its_chip)
    : chip(its_chip),
      data(its_chip.ram_end + 1u),
      flash(its_chip.flash_bytes, uint8_t{0xFF}),
      registers(its_chip.first_ram - first_register) {}

void Mcu::reset() {
  std::fill(data.begin() + first_register, data.begin() + chip.first_ram, uint8_t{0});
  for (const InitialValue& initial : initial_values)
    if (initial.reg < usart1 || chip.wide_pc) data[initial.reg] = initial.value;
  data[reg::SPL] = static_cast<uint8_t>(chip.ram_end);
  data[reg::SPH] = static_cast<uint8_t>(chip.ram_end >> 8);
  flags.fill(0);
  pc = reset_vector;
  state = State::running;
  events.clear();
  pending = 0;
  crash_reason.clear();
}

uint8_t Mcu::read(uint32_t address) {
  if (address > chip.ram_end) {
    crash("a read beyond the end of RAM, from", address);
    return 0;
  }
  if (address == reg::SREG) {
    data[address] = sreg();
  } else if (address - first_register < registers.size()) {
    const Register& hook = registers[address - first_register];
    if (hook.read) data[address] = hook.read(hook.reader, static_cast<uint16_t>(address));
  }
  return data[address];
}

void Mcu::write(uint32_t address, uint8_t value) {
  if (address > chip.ram_end) {
    crash("a write beyond the end of RAM, to", address);
    return;
  }
  if (address == reg::SREG) {
    set_sreg(value);
  } else if (address - first_register < registers.size()) {
    const Register& hook = registers[address - first_register];
    if (hook.write) {
      hook.write(hook.writer, static_cast<uint16_t>(address), value);
      return;
    }
  }
  data[address] = value;
}

void Mcu::push_address(uint32_t address) {
  uint32_t stack = data[reg::SPL] | static_cast<uint32_t>(data[reg::SPH]) << 8;
  for (unsigned byte = 0; byte < (chip.wide_pc ? 3u : 2u); ++byte)
    write(stack-- & 0xFFFFu, static_cast<uint8_t>(address >> (8 * byte + 1)));
  data[reg::SPL] = static_cast<uint8_t>(stack);
  data[reg::SPH] = static_cast<uint8_t>(stack >> 8);
}

void Mcu::crash(const char* what, uint32_t value) {
  char text[120];
  std::snprintf(text, sizeof text, "%s 0x%04X", what, value);
  crash_reason = text;
  state = State::crashed;
}

uint8_t Mcu::sreg() const {
  unsigned bits = 0;
  for (unsigned bit = 0; bit < flags.size(); ++bit) bits |= static_cast<unsigned>(flags[bit]) << bit;
  return static_cast<uint8_t>(bits);
}

void Mcu::set_sreg(uint8_t value) {
  for (unsigned bit = 0; bit < flag::I; ++bit) flags[bit] = value >> bit & 1u;
  set_interrupt_flag(value >> flag::I & 1u);
}

// The instruction behind the one that sets I is executed before any interrupt (data sheet, "Reset and Interrupt
// Handling").
void Mcu::set_interrupt_flag(bool on) {
  if (!on) pending &= ~uint64_t{1};
  else if (!flags[flag::I]) pending |= 1;
  flags[flag::I] = on;
}

}  // namespace board
