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

namespace {

constexpr size_t longest_step = 3;  // words from an instruction to the next without a jump

}  // namespace

Cpu::Cpu(avr_t& avr, const Chip& chip)
    : avr_(avr),
      decoder_(avr.flash, (avr.flashend + 1) / 2, chip.wide_pc),
      mask_((avr.flashend + 1) / 2 - 1),
      wide_pc_(chip.wide_pc),
      decoded_(mask_ + 1) {
  decoded_.resize(decoded_.size() + longest_step, {Code::wrapped});  // the flash begins anew behind its end
}

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
  const Instruction* op = decoded + avr.pc / 2;
  const auto pc = [&]() ALWAYS_INLINE { return static_cast<uint32_t>(op - decoded); };
  uint64_t cycle = avr.cycle;
  // An interrupt that waits for one more instruction is a deadline that has passed.
  uint64_t deadline = avr.interrupt_state ? 0 : cycle + avr.run_cycle_count;

  const auto with_simavr = [&](auto action) ALWAYS_INLINE {
    avr.pc = pc() * 2;
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

  const auto d = [&]() ALWAYS_INLINE -> uint8_t& { return data[op->d]; };
  const auto r = [&]() ALWAYS_INLINE { return static_cast<unsigned>(data[op->r]); };
  const auto k8 = [&]() ALWAYS_INLINE { return op->k & 0xFFu; };
  const auto at = [&](uint32_t address) ALWAYS_INLINE { return decoded + (address & mask); };
  const Instruction* next;
  const auto branch = [&](bool condition) ALWAYS_INLINE {
    if (!condition) return;
    next = at(op->k);
    ++cycle;
  };
  const auto skip = [&](bool condition, uint32_t words) ALWAYS_INLINE {
    if (!condition) return;
    next += words;
    cycle += words;
  };
  const auto set_flag = [&](uint8_t value) ALWAYS_INLINE {
    if (op->r == S_I) with_simavr([&] { avr_sreg_set(&avr, S_I, value); });
    else flags[op->r] = value;
  };
  const auto load_and_move = [&](uint32_t pointer, uint32_t moved) ALWAYS_INLINE {
    const uint8_t value = read(pointer & 0xFFFFu);
    set_word(op->r, moved);
    d() = value;
  };
  const auto store_and_move = [&](uint32_t pointer, uint32_t moved) ALWAYS_INLINE {
    write(pointer & 0xFFFFu, d());
    set_word(op->r, moved);
  };
  const auto load_flash_and_move = [&](uint32_t z) ALWAYS_INLINE {
    d() = flash[z & flash_end];
    set_word(R_ZL, z + 1);
    return static_cast<uint8_t>((z + 1) >> 16);
  };
  const auto refuse = [&]() ALWAYS_INLINE {
    crash("an invalid instruction,", static_cast<uint32_t>(flash[2 * pc()] | flash[2 * pc() + 1] << 8));
  };
  const auto allow_interrupts = [&]() ALWAYS_INLINE {
    avr_sreg_set(&avr, S_I, 1);
    avr_interrupt_reti(&avr);
  };
  const auto fall_asleep = [&]() ALWAYS_INLINE {
    if (!avr_has_pending_interrupts(&avr) || !flags[S_I]) avr.state = cpu_Sleeping;
  };

  // A jump of its own behind each instruction: the processor foresees it by the instruction before.
#define LABEL(code) (&&code),
  static const void* const labels[] = {BOARD_CODES(LABEL)};
#undef LABEL
#define DISPATCH \
  next = op + 1; \
  goto* labels[static_cast<size_t>(op->code)]
#define ON(code, ...)              \
  code:                            \
  __VA_ARGS__;                     \
  cycle += op->cycles;             \
  op = next;                       \
  if (cycle >= deadline) goto due; \
  DISPATCH

  DISPATCH;

undecoded:
  decoded[pc()] = decoder_.decode(pc());
  DISPATCH;
wrapped:
  op -= mask + 1;
  DISPATCH;
  ON(invalid, with_simavr(refuse), next = op);
  ON(nop, {});

  ON(add, d() = alu.add(d(), r(), 0));
  ON(adc, d() = alu.add(d(), r(), flags[S_C]));
  ON(sub, d() = alu.subtract(d(), r(), 0));
  ON(sbc, d() = alu.subtract_with_borrow(d(), r()));
  ON(logic_and, d() = alu.logic(d() & r()));
  ON(logic_or, d() = alu.logic(d() | r()));
  ON(logic_xor, d() = alu.logic(d() ^ r()));
  ON(mov, d() = data[op->r]);
  ON(cp, alu.subtract(d(), r(), 0));
  ON(cpc, alu.subtract_with_borrow(d(), r()));
  ON(subi, d() = alu.subtract(d(), k8(), 0));
  ON(sbci, d() = alu.subtract_with_borrow(d(), k8()));
  ON(andi, d() = alu.logic(d() & k8()));
  ON(ori, d() = alu.logic(d() | k8()));
  ON(ldi, d() = static_cast<uint8_t>(op->k));
  ON(cpi, alu.subtract(d(), k8(), 0));

  ON(com, d() = alu.complement(d()));
  ON(neg, d() = alu.subtract(0, d(), 0));
  ON(swap, d() = static_cast<uint8_t>(d() >> 4 | d() << 4));
  ON(inc, d() = alu.increment(d()));
  ON(dec, d() = alu.decrement(d()));
  ON(asr, d() = alu.shift_right(d(), d() >> 7));
  ON(lsr, d() = alu.shift_right(d(), 0));
  ON(ror, d() = alu.shift_right(d(), flags[S_C]));
  ON(movw, set_word(op->d, word(op->r)));
  ON(adiw, set_word(op->d, alu.add_word(word(op->d), k8())));
  ON(sbiw, set_word(op->d, alu.subtract_word(word(op->d), k8())));
  ON(mul, set_word(0, alu.product(static_cast<int>(d() * r()), false)));
  ON(muls, set_word(0, alu.product(as_signed(op->d) * as_signed(op->r), false)));
  ON(mulsu, set_word(0, alu.product(as_signed(op->d) * static_cast<int>(r()), false)));
  ON(fmul, set_word(0, alu.product(static_cast<int>(d() * r()), true)));
  ON(fmuls, set_word(0, alu.product(as_signed(op->d) * as_signed(op->r), true)));
  ON(fmulsu, set_word(0, alu.product(as_signed(op->d) * static_cast<int>(r()), true)));

  ON(bset, set_flag(1));
  ON(bclr, set_flag(0));
  ON(bst, flags[S_T] = static_cast<uint8_t>(d() >> op->r & 1));
  ON(bld, d() = static_cast<uint8_t>((d() & ~(1u << op->r)) | static_cast<unsigned>(flags[S_T]) << op->r));
  ON(sbi, write_io(op->k, read_io(op->k) | op->r));
  ON(cbi, write_io(op->k, read_io(op->k) & ~static_cast<unsigned>(op->r)));

  ON(load, d() = read((word(op->r) + op->k) & 0xFFFFu));
  ON(load_increment, load_and_move(word(op->r), word(op->r) + 1));
  ON(load_decrement, load_and_move(word(op->r) - 1, word(op->r) - 1));
  ON(load_direct, d() = read(op->k), ++next);
  ON(in, d() = read_io(op->k));
  ON(store, write((word(op->r) + op->k) & 0xFFFFu, d()));
  ON(store_increment, store_and_move(word(op->r), word(op->r) + 1));
  ON(store_decrement, store_and_move(word(op->r) - 1, word(op->r) - 1));
  ON(store_direct, write(op->k, d()), ++next);
  ON(out, write_io(op->k, d()));
  ON(push, push(d()));
  ON(pop, d() = pop());

  ON(lpm, d() = flash[word(R_ZL) & flash_end]);
  ON(elpm, d() = flash[extended_z(reg::RAMPZ) & flash_end]);
  ON(lpm_increment, load_flash_and_move(word(R_ZL)));
  ON(elpm_increment, data[reg::RAMPZ] = load_flash_and_move(extended_z(reg::RAMPZ)));
  ON(spm, with_simavr([&] { avr_ioctl(&avr, AVR_IOCTL_FLASH_SPM, nullptr); }));

  ON(jump, next = at(op->k));
  ON(call, push_return(pc() + op->d), next = at(op->k));
  ON(ijmp, next = at(word(R_ZL)));
  ON(eijmp, next = at(extended_z(reg::EIND)));
  ON(icall, push_return(pc() + 1), next = at(word(R_ZL)));
  ON(eicall, push_return(pc() + 1), next = at(extended_z(reg::EIND)));
  ON(reti, with_simavr(allow_interrupts), next = at(pop_return()));
  ON(ret, next = at(pop_return()));
  ON(branch_if_set, branch(flags[op->r]));
  ON(branch_if_clear, branch(!flags[op->r]));
  ON(cpse, skip(d() == r(), op->k));
  ON(sbrc, skip(!(d() >> op->r & 1), op->k));
  ON(sbrs, skip(d() >> op->r & 1, op->k));
  ON(sbic, skip(!(read_io(op->k) & op->r), op->d));
  ON(sbis, skip(read_io(op->k) & op->r, op->d));
  ON(sleep, with_simavr(fall_asleep));
  ON(wdr, with_simavr([&] { avr_ioctl(&avr, AVR_IOCTL_WATCHDOG_RESET, nullptr); }));
#undef ON
#undef DISPATCH

due:
  avr.cycle = cycle;
  return (pc() & mask) * 2;
}

}  // namespace board
