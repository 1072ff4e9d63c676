// SPDX-License-Identifier: GPL-3.0-or-later
// Execution of AVR instructions. Program counter, time and deadline live in local variables; simavr's own fields are
// brought up to date around everything that may look at them, such as the register hooks of the peripherals.
#include "cpu.h"

#include <algorithm>
#include <cstdio>

#include "alu.h"

extern "C" {
#include <simavr/avr_flash.h>
}

#define ALWAYS_INLINE __attribute__((always_inline))

namespace board {

Cpu::Cpu(avr_t& avr, const Chip& chip)
    : avr_(avr),
      decoder_(avr.flash, (avr.flashend + 1) / 2, chip.wide_pc),
      mask_((avr.flashend + 1) / 2 - 1),
      wide_pc_(chip.wide_pc),
      decoded_(mask_ + 1) {}

// An instruction also depends on up to two words after it.
void Cpu::flash_changed(uint32_t address, uint32_t count) {
  const uint32_t first = address / 2 + mask_ + 1 - 2, words = (count + 1) / 2 + 3;
  for (uint32_t word = first; word < first + words; ++word) decoded_[word & mask_] = {};
}

void Cpu::crash(const char* what, uint32_t value) {
  char text[120];
  std::snprintf(text, sizeof text, "%s 0x%04X", what, value);
  hooks_of(avr_).last_error = text;
  avr_.state = cpu_Crashed;
}

uint8_t Cpu::read_register(uint32_t address) {
  uint8_t* const data = avr_.data;
  if (address > avr_.ramend) {
    crash("a read beyond the end of RAM, from", address);
    return 0;
  }
  if (address == reg::SREG) {
    unsigned sreg = 0;
    for (unsigned bit = 0; bit < 8; ++bit) sreg |= static_cast<unsigned>(avr_.sreg[bit]) << bit;
    data[address] = static_cast<uint8_t>(sreg);
  } else if (address - 32 < MAX_IOs) {
    const auto& hook = avr_.io[AVR_DATA_TO_IO(address)].r;
    if (hook.c) data[address] = hook.c(&avr_, static_cast<avr_io_addr_t>(address), hook.param);
  }
  return data[address];
}

void Cpu::write_register(uint32_t address, uint8_t value) {
  if (address > avr_.ramend) {
    crash("a write beyond the end of RAM, to", address);
    return;
  }
  if (address == reg::SREG) {
    for (uint8_t bit = 0; bit < 8; ++bit) avr_sreg_set(&avr_, bit, value >> bit & 1);
  } else if (address - 32 < MAX_IOs) {
    const auto& hook = avr_.io[AVR_DATA_TO_IO(address)].w;
    if (hook.c) {
      hook.c(&avr_, static_cast<avr_io_addr_t>(address), value, hook.param);
      return;
    }
  }
  avr_.data[address] = value;
}

// One long function on purpose: everything it needs stays in registers from one instruction to the next.
avr_flashaddr_t Cpu::run() {
  avr_t& avr = avr_;
  uint8_t* const data = avr.data;
  uint8_t* const flags = avr.sreg;
  const uint8_t* const flash = avr.flash;
  Instruction* const decoded = decoded_.data();
  const Alu alu(flags);
  const uint32_t mask = mask_, flash_end = avr.flashend, first_ram = avr.ioend + 1u, ram_end = avr.ramend;
  const bool wide_pc = wide_pc_;
  uint32_t pc = avr.pc / 2;
  uint64_t cycle = avr.cycle;
  // An interrupt that waits for one more instruction is a deadline that has passed.
  uint64_t deadline = avr.interrupt_state ? 0 : cycle + avr.run_cycle_count;

  const auto with_simavr = [&](auto action) ALWAYS_INLINE {
    avr.pc = pc * 2;
    avr.cycle = cycle;
    avr.run_cycle_count = deadline > cycle ? deadline - cycle : 1;
    action();
    cycle = avr.cycle;
    deadline = avr.interrupt_state || avr.state != cpu_Running ? 0 : cycle + avr.run_cycle_count;
  };
  const auto read_io = [&](uint32_t address) ALWAYS_INLINE {
    uint8_t value = 0;
    with_simavr([&] { value = read_register(address); });
    return value;
  };
  const auto write_io = [&](uint32_t address, unsigned value) ALWAYS_INLINE {
    with_simavr([&] { write_register(address, static_cast<uint8_t>(value)); });
  };
  const auto read = [&](uint32_t address) ALWAYS_INLINE {
    return address >= first_ram && address <= ram_end ? data[address] : read_io(address);
  };
  const auto write = [&](uint32_t address, uint8_t value) ALWAYS_INLINE {
    if (address >= first_ram && address <= ram_end) data[address] = value;
    else write_io(address, value);
  };
  const auto word = [&](unsigned low) ALWAYS_INLINE { return data[low] | static_cast<uint32_t>(data[low + 1]) << 8; };
  const auto set_word = [&](unsigned low, uint32_t value) ALWAYS_INLINE {
    data[low] = static_cast<uint8_t>(value);
    data[low + 1] = static_cast<uint8_t>(value >> 8);
  };
  const auto push = [&](uint32_t value) ALWAYS_INLINE {
    const uint32_t stack = word(reg::SPL);
    write(stack, static_cast<uint8_t>(value));
    set_word(reg::SPL, stack - 1);
  };
  const auto pop = [&]() ALWAYS_INLINE {
    const uint32_t stack = (word(reg::SPL) + 1) & 0xFFFFu;
    const uint8_t value = read(stack);
    set_word(reg::SPL, stack);
    return value;
  };
  const auto push_return = [&](uint32_t address) ALWAYS_INLINE {
    push(address);
    push(address >> 8);
    if (wide_pc) push(address >> 16);
  };
  const auto pop_return = [&]() ALWAYS_INLINE {
    uint32_t address = wide_pc ? static_cast<uint32_t>(pop()) << 16 : 0u;
    address |= static_cast<uint32_t>(pop()) << 8;
    return address | pop();
  };
  const auto extended_z = [&](uint16_t high)
                              ALWAYS_INLINE { return word(R_ZL) | static_cast<uint32_t>(data[high]) << 16; };
  const auto as_signed = [&](unsigned reg) ALWAYS_INLINE { return static_cast<int>(static_cast<int8_t>(data[reg])); };

  for (;;) {
    const Instruction& op = decoded[pc];
    uint8_t& d = data[op.d];
    const auto r = [&]() ALWAYS_INLINE { return static_cast<unsigned>(data[op.r]); };
    const auto k8 = [&]() ALWAYS_INLINE { return op.k & 0xFFu; };
    uint32_t next = pc + 1;
    const auto skip = [&](bool condition, uint32_t words) ALWAYS_INLINE {
      if (!condition) return;
      next += words;
      cycle += words;
    };
    switch (op.code) {
      case Code::undecoded: decoded[pc] = decoder_.decode(pc); continue;
      case Code::invalid:
        with_simavr(
            [&] { crash("an invalid instruction,", static_cast<uint32_t>(flash[2 * pc] | flash[2 * pc + 1] << 8)); });
        next = pc;
        break;
      case Code::nop: break;

      case Code::add: d = alu.add(d, r(), 0); break;
      case Code::adc: d = alu.add(d, r(), flags[S_C]); break;
      case Code::sub: d = alu.subtract(d, r(), 0); break;
      case Code::sbc: d = alu.subtract_with_borrow(d, r()); break;
      case Code::logic_and: d = alu.logic(d & r()); break;
      case Code::logic_or: d = alu.logic(d | r()); break;
      case Code::logic_xor: d = alu.logic(d ^ r()); break;
      case Code::mov: d = data[op.r]; break;
      case Code::cp: alu.subtract(d, r(), 0); break;
      case Code::cpc: alu.subtract_with_borrow(d, r()); break;
      case Code::subi: d = alu.subtract(d, k8(), 0); break;
      case Code::sbci: d = alu.subtract_with_borrow(d, k8()); break;
      case Code::andi: d = alu.logic(d & k8()); break;
      case Code::ori: d = alu.logic(d | k8()); break;
      case Code::ldi: d = static_cast<uint8_t>(op.k); break;
      case Code::cpi: alu.subtract(d, k8(), 0); break;

      case Code::com: d = alu.complement(d); break;
      case Code::neg: d = alu.subtract(0, d, 0); break;
      case Code::swap: d = static_cast<uint8_t>(d >> 4 | d << 4); break;
      case Code::inc: d = alu.increment(d); break;
      case Code::dec: d = alu.decrement(d); break;
      case Code::asr: d = alu.shift_right(d, d >> 7); break;
      case Code::lsr: d = alu.shift_right(d, 0); break;
      case Code::ror: d = alu.shift_right(d, flags[S_C]); break;
      case Code::movw: set_word(op.d, word(op.r)); break;
      case Code::adiw: set_word(op.d, alu.add_word(word(op.d), k8())); break;
      case Code::sbiw: set_word(op.d, alu.subtract_word(word(op.d), k8())); break;
      case Code::mul: set_word(0, alu.product(static_cast<int>(d * r()), false)); break;
      case Code::muls: set_word(0, alu.product(as_signed(op.d) * as_signed(op.r), false)); break;
      case Code::mulsu: set_word(0, alu.product(as_signed(op.d) * static_cast<int>(r()), false)); break;
      case Code::fmul: set_word(0, alu.product(static_cast<int>(d * r()), true)); break;
      case Code::fmuls: set_word(0, alu.product(as_signed(op.d) * as_signed(op.r), true)); break;
      case Code::fmulsu: set_word(0, alu.product(as_signed(op.d) * static_cast<int>(r()), true)); break;

      case Code::bset:
      case Code::bclr: {
        const uint8_t value = op.code == Code::bset;
        if (op.r == S_I) with_simavr([&] { avr_sreg_set(&avr, S_I, value); });
        else flags[op.r] = value;
        break;
      }
      case Code::bst: flags[S_T] = static_cast<uint8_t>(d >> op.r & 1); break;
      case Code::bld: d = static_cast<uint8_t>((d & ~(1u << op.r)) | static_cast<unsigned>(flags[S_T]) << op.r); break;
      case Code::sbi: write_io(op.k, read_io(op.k) | op.r); break;
      case Code::cbi: write_io(op.k, read_io(op.k) & ~static_cast<unsigned>(op.r)); break;

      case Code::load: d = read((word(op.r) + op.k) & 0xFFFFu); break;
      case Code::load_increment: {
        const uint32_t pointer = word(op.r);
        const uint8_t value = read(pointer);
        set_word(op.r, pointer + 1);
        d = value;
        break;
      }
      case Code::load_decrement: {
        const uint32_t pointer = (word(op.r) - 1) & 0xFFFFu;
        const uint8_t value = read(pointer);
        set_word(op.r, pointer);
        d = value;
        break;
      }
      case Code::load_direct:
        d = read(op.k);
        next = pc + 2;
        break;
      case Code::in: d = read_io(op.k); break;
      case Code::store: write((word(op.r) + op.k) & 0xFFFFu, d); break;
      case Code::store_increment: {
        const uint32_t pointer = word(op.r);
        write(pointer, d);
        set_word(op.r, pointer + 1);
        break;
      }
      case Code::store_decrement: {
        const uint32_t pointer = (word(op.r) - 1) & 0xFFFFu;
        write(pointer, d);
        set_word(op.r, pointer);
        break;
      }
      case Code::store_direct:
        write(op.k, d);
        next = pc + 2;
        break;
      case Code::out: write_io(op.k, d); break;
      case Code::push: push(d); break;
      case Code::pop: d = pop(); break;

      case Code::lpm: d = flash[word(R_ZL) & flash_end]; break;
      case Code::elpm: d = flash[extended_z(reg::RAMPZ) & flash_end]; break;
      case Code::lpm_increment: {
        const uint32_t z = word(R_ZL);
        d = flash[z & flash_end];
        set_word(R_ZL, z + 1);
        break;
      }
      case Code::elpm_increment: {
        const uint32_t z = extended_z(reg::RAMPZ);
        d = flash[z & flash_end];
        data[reg::RAMPZ] = static_cast<uint8_t>((z + 1) >> 16);
        set_word(R_ZL, z + 1);
        break;
      }
      case Code::spm: with_simavr([&] { avr_ioctl(&avr, AVR_IOCTL_FLASH_SPM, nullptr); }); break;

      case Code::jump: next = op.k; break;
      case Code::call:
        push_return(pc + op.d);
        next = op.k;
        break;
      case Code::ijmp: next = word(R_ZL); break;
      case Code::eijmp: next = extended_z(reg::EIND); break;
      case Code::icall:
        push_return(next);
        next = word(R_ZL);
        break;
      case Code::eicall:
        push_return(next);
        next = extended_z(reg::EIND);
        break;
      case Code::reti:
        with_simavr([&] {
          avr_sreg_set(&avr, S_I, 1);
          avr_interrupt_reti(&avr);
        });
        next = pop_return();
        break;
      case Code::ret: next = pop_return(); break;
      case Code::branch_if_set:
      case Code::branch_if_clear:
        if (flags[op.r] == (op.code == Code::branch_if_set)) {
          next = op.k;
          ++cycle;
        }
        break;
      case Code::cpse: skip(d == r(), op.k); break;
      case Code::sbrc: skip(!(d >> op.r & 1), op.k); break;
      case Code::sbrs: skip(d >> op.r & 1, op.k); break;
      case Code::sbic: skip(!(read_io(op.k) & op.r), op.d); break;
      case Code::sbis: skip(read_io(op.k) & op.r, op.d); break;
      case Code::sleep:
        with_simavr([&] {
          if (!avr_has_pending_interrupts(&avr) || !flags[S_I]) avr.state = cpu_Sleeping;
        });
        break;
      case Code::wdr: with_simavr([&] { avr_ioctl(&avr, AVR_IOCTL_WATCHDOG_RESET, nullptr); }); break;
      default: __builtin_unreachable();  // spares the dispatch a range check
    }
    cycle += op.cycles;
    pc = next & mask;
    if (cycle >= deadline) break;
  }
  avr.cycle = cycle;
  return pc * 2;
}

}  // namespace board
