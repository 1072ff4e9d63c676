// What CPU and peripherals share: memories, program counter, time, status flags, the hooks of the I/O registers, events
// and pending interrupts.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "chip.h"
#include "events.h"

namespace board {

// The flags by their bits in SREG.
namespace flag {
enum : uint8_t { C, Z, N, V, S, H, T, I };
}

struct Mcu {
  enum class State : uint8_t { running, asleep, done, crashed, watchdog_reset };  // done: asleep for good
  struct Register {
    uint8_t (*read)(void* model, uint16_t reg) = nullptr;
    void* reader = nullptr;
    void (*write)(void* model, uint16_t reg, uint8_t value) = nullptr;
    void* writer = nullptr;
  };
  struct Action {
    void (*call)(void* model) = nullptr;
    void* model = nullptr;
    void operator()() const { call(model); }
  };

  explicit Mcu(const Chip& its_chip);
  void reset();

  // Data memory as an instruction sees it: with the hooks of registers, SREG, and a crash where there is nothing.
  uint8_t read(uint32_t address);
  void write(uint32_t address, uint8_t value);
  void push_address(uint32_t address);  // a byte address, as the hardware does it: a word address, low byte first
  void crash(const char* what, uint32_t value);

  uint8_t sreg() const;
  void set_sreg(uint8_t value);
  void set_interrupt_flag(bool on);

  // The CPU may run up to this cycle before anything else wants to.
  uint64_t deadline() const { return state != State::running || (flags[flag::I] && pending) ? 0 : events.next(); }

  const Chip& chip;
  std::vector<uint8_t> data, flash;
  std::vector<Register> registers;    // from first_register to the RAM; one without a hook is plain memory
  std::array<uint8_t, 8> flags{};     // of SREG, each in a byte of its own
  uint32_t pc = 0, reset_vector = 0;  // byte addresses
  uint64_t cycle = 0;
  State state = State::running;
  Events events;
  uint64_t pending = 0;            // bit i: interrupt vector i; bit 0: one more instruction comes first
  Action spm, wdr, reti;           // instructions whose work a peripheral does
  uint32_t supply_millivolts = 0;  // at VCC, AVCC and AREF
  std::string crash_reason;
};

// Calls model.*Method(reg, value) when the program writes the register. The method stores the value itself.
template <auto Method, class Model>
void on_write(Mcu& mcu, uint16_t reg, Model& model) {
  Mcu::Register& hook = mcu.registers[reg - first_register];
  hook.writer = &model;
  hook.write = [](void* self, uint16_t at, uint8_t value) { (static_cast<Model*>(self)->*Method)(at, value); };
}

// Calls model.*Method(reg) when the program reads the register; what it returns is what the program sees.
template <auto Method, class Model>
void on_read(Mcu& mcu, uint16_t reg, Model& model) {
  Mcu::Register& hook = mcu.registers[reg - first_register];
  hook.reader = &model;
  hook.read = [](void* self, uint16_t at) { return (static_cast<Model*>(self)->*Method)(at); };
}

// Calls model.*Method() where the program executes the instruction.
template <auto Method, class Model>
Mcu::Action action(Model& model) {
  return {[](void* self) { (static_cast<Model*>(self)->*Method)(); }, &model};
}

template <auto Method, class Model>
void event_handler(void* self, uint64_t cycle) {
  (static_cast<Model*>(self)->*Method)(cycle);
}

// Calls model.*Method(cycle) at the given cycle, or as soon after it as the CPU stands still. Scheduling the same
// method again moves the event.
template <auto Method, class Model>
void schedule(Mcu& mcu, uint64_t cycle, Model& model) {
  mcu.events.set(cycle, &event_handler<Method, Model>, &model);
}

template <auto Method, class Model>
void cancel(Mcu& mcu, Model& model) {
  mcu.events.cancel(&event_handler<Method, Model>, &model);
}

inline unsigned running_opcode(const Mcu& mcu) {
  return static_cast<unsigned>(mcu.flash[mcu.pc] | mcu.flash[mcu.pc + 1] << 8);
}

// Inside a register hook: the cycle at which the running store instruction ends. The hook is called at its start.
inline uint64_t store_ends(const Mcu& mcu) {
  const bool is_out = (running_opcode(mcu) & 0xF800u) == 0xB800u;
  return mcu.cycle + (is_out ? 1u : 2u);
}

// Inside a hook of a write-one-to-act register below 0x40: the bits the program meant. The CPU turns SBI into
// read-modify-write, but the chip acts on the one bit only.
inline uint8_t bits_written(const Mcu& mcu, uint8_t value) {
  const unsigned opcode = running_opcode(mcu);
  const bool is_sbi = (opcode & 0xFF00u) == 0x9A00u;
  return is_sbi ? static_cast<uint8_t>(1u << (opcode & 7u)) : value;
}

}  // namespace board
