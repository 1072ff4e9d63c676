// SPDX-License-Identifier: GPL-3.0-or-later
// AVR instructions, decoded once: what to do, with which registers, how long.
#pragma once

#include <cstdint>

namespace board {

enum class Code : uint8_t {
  undecoded,
  invalid,
  nop,
  // arithmetic and logic, registers d and r or the constant k
  add,
  adc,
  sub,
  sbc,
  logic_and,
  logic_or,
  logic_xor,
  mov,
  cp,
  cpc,
  subi,
  sbci,
  andi,
  ori,
  ldi,
  cpi,
  com,
  neg,
  swap,
  inc,
  dec,
  asr,
  lsr,
  ror,
  movw,
  adiw,
  sbiw,
  mul,
  muls,
  mulsu,
  fmul,
  fmuls,
  fmulsu,
  // bits; r is the bit number, or a mask for I/O bits
  bset,
  bclr,
  bst,
  bld,
  sbi,
  cbi,
  // data memory; r is the pointer register of the indirect forms, k the address or the displacement
  load,
  load_increment,
  load_decrement,
  load_direct,
  in,
  store,
  store_increment,
  store_decrement,
  store_direct,
  out,
  push,
  pop,
  // program memory
  lpm,
  lpm_increment,
  elpm,
  elpm_increment,
  spm,
  // flow; k is the target, or the number of words to skip
  jump,
  call,
  ijmp,
  eijmp,
  icall,
  eicall,
  ret,
  reti,
  branch_if_set,
  branch_if_clear,
  cpse,
  sbrc,
  sbrs,
  sbic,
  sbis,
  sleep,
  wdr,
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
