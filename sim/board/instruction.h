// AVR instructions, decoded once: what to do, with which registers, how long.
#pragma once

#include <cstdint>

namespace board {

// clang-format off
// All of them; the CPU has a label for each.
#define BOARD_CODES(X) \
  X(undecoded) X(wrapped) X(invalid) X(nop) \
  /* arithmetic and logic, registers d and r or the constant k */ \
  X(add) X(adc) X(sub) X(sbc) X(logic_and) X(logic_or) X(logic_xor) X(mov) X(cp) X(cpc) \
  X(subi) X(sbci) X(andi) X(ori) X(ldi) X(cpi) \
  X(com) X(neg) X(swap) X(inc) X(dec) X(asr) X(lsr) X(ror) X(movw) X(adiw) X(sbiw) \
  X(mul) X(muls) X(mulsu) X(fmul) X(fmuls) X(fmulsu) \
  /* bits; r is the bit number, or a mask for I/O bits */ \
  X(bset) X(bclr) X(bst) X(bld) X(sbi) X(cbi) \
  /* data memory; r is the pointer register of the indirect forms, k the address or the displacement */ \
  X(load) X(load_increment) X(load_decrement) X(load_direct) X(in) \
  X(store) X(store_increment) X(store_decrement) X(store_direct) X(out) X(push) X(pop) \
  /* program memory */ \
  X(lpm) X(lpm_increment) X(elpm) X(elpm_increment) X(spm) \
  /* flow; k is the target, or the number of words to skip */ \
  X(jump) X(call) X(ijmp) X(eijmp) X(icall) X(eicall) X(ret) X(reti) \
  X(cpse) X(sbrc) X(sbrs) X(sbic) X(sbis) X(sleep) X(wdr) \
  /* branches in the order of the flags in SREG; d is the flag's value that branches */ \
  X(branch_by_carry) X(branch_by_zero) X(branch_by_negative) X(branch_by_overflow) \
  X(branch_by_sign) X(branch_by_half_carry) X(branch_by_transfer) X(branch_by_interrupts)
// clang-format on

enum class Code : uint8_t {
#define BOARD_ENUMERATOR(code) code,
  BOARD_CODES(BOARD_ENUMERATOR)
#undef BOARD_ENUMERATOR
};

struct Instruction {
  Code code = Code::undecoded;
  uint8_t d = 0;
  uint8_t r = 0;
  uint8_t cycles = 1;  // without what a taken branch or skip adds
  uint32_t k = 0;
};

// Decodes the instruction at a word address. Addresses wrap at the end of the flash, whose size is a power of two.
class Decoder {
 public:
  Decoder(const uint8_t* flash, uint32_t words, bool wide_pc) : flash_(flash), mask_(words - 1), wide_pc_(wide_pc) {}
  Instruction decode(uint32_t address) const;

 private:
  uint16_t word(uint32_t address) const;
  uint32_t skip_length(uint32_t address) const;
  Instruction decode_two_registers(unsigned opcode, uint32_t address) const;
  Instruction decode_multiply(unsigned opcode) const;
  Instruction decode_load_store(unsigned opcode, uint32_t address) const;
  Instruction decode_one_register(unsigned opcode, uint32_t address) const;
  Instruction decode_miscellaneous(unsigned opcode) const;
  Instruction decode_io_bit(unsigned opcode, uint32_t address) const;

  const uint8_t* flash_;
  uint32_t mask_;
  bool wide_pc_;  // a 22-bit program counter: calls and returns take a cycle more, EIJMP, EICALL and ELPM exist
};

}  // namespace board
