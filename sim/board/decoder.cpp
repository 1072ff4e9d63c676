// Decoding after the "AVR Instruction Set Manual"; cycles are those of the ATmega (AVRe+) family.
#include "instruction.h"

namespace board {

namespace {

constexpr unsigned pointer_x = 26, pointer_y = 28, pointer_z = 30;

constexpr uint8_t byte(unsigned value) { return static_cast<uint8_t>(value); }
constexpr unsigned register_d(unsigned opcode) { return opcode >> 4 & 0x1F; }
constexpr unsigned register_r(unsigned opcode) { return (opcode & 0x0F) | (opcode >> 5 & 0x10); }
constexpr unsigned upper_register_d(unsigned opcode) { return 16 + (opcode >> 4 & 0x0F); }
constexpr unsigned constant_k(unsigned opcode) { return (opcode & 0x0F) | (opcode >> 4 & 0xF0); }

Instruction make(Code code, unsigned d = 0, unsigned r = 0, unsigned cycles = 1, uint32_t k = 0) {
  return {code, byte(d), byte(r), byte(cycles), k};
}

}  // namespace

uint16_t Decoder::word(uint32_t address) const {
  const uint8_t* bytes = flash_ + 2 * (address & mask_);
  return static_cast<uint16_t>(bytes[0] | bytes[1] << 8);
}

// Words that an instruction before the address skips: two for LDS, STS, JMP and CALL.
uint32_t Decoder::skip_length(uint32_t address) const {
  const unsigned opcode = word(address);
  const bool direct = (opcode & 0xFC0Fu) == 0x9000u;
  const bool far = (opcode & 0xFE0Cu) == 0x940Cu;
  return direct || far ? 2 : 1;
}

Instruction Decoder::decode(uint32_t address) const {
  const unsigned opcode = word(address);
  const auto relative = [&](unsigned bits, unsigned shift) {  // a signed distance in words
    const unsigned field = opcode >> shift & ((1u << bits) - 1u);
    const uint32_t distance = field & 1u << (bits - 1) ? field - (1u << bits) : field;
    return (address + 1 + distance) & mask_;
  };
  switch (opcode >> 12) {
    case 0x0:
    case 0x1:
    case 0x2: return decode_two_registers(opcode, address);
    case 0x3: return make(Code::cpi, upper_register_d(opcode), 0, 1, constant_k(opcode));
    case 0x4: return make(Code::sbci, upper_register_d(opcode), 0, 1, constant_k(opcode));
    case 0x5: return make(Code::subi, upper_register_d(opcode), 0, 1, constant_k(opcode));
    case 0x6: return make(Code::ori, upper_register_d(opcode), 0, 1, constant_k(opcode));
    case 0x7: return make(Code::andi, upper_register_d(opcode), 0, 1, constant_k(opcode));
    case 0x8:
    case 0xA: {  // LDD and STD with a displacement
      const unsigned pointer = opcode & 8u ? pointer_y : pointer_z;
      const unsigned displacement = (opcode & 7u) | (opcode >> 7 & 0x18u) | (opcode >> 8 & 0x20u);
      return make(opcode & 0x200u ? Code::store : Code::load, register_d(opcode), pointer, 2, displacement);
    }
    case 0x9:
      if (opcode < 0x9400u) return decode_load_store(opcode, address);
      if (opcode < 0x9600u) return decode_one_register(opcode, address);
      if (opcode < 0x9800u)
        return make(opcode & 0x100u ? Code::sbiw : Code::adiw, 24 + (opcode >> 3 & 6u), 0, 2,
                    (opcode & 0x0Fu) | (opcode >> 2 & 0x30u));
      if (opcode < 0x9C00u) return decode_io_bit(opcode, address);
      return make(Code::mul, register_d(opcode), register_r(opcode), 2);
    case 0xB: {
      const uint32_t port = 0x20u + ((opcode & 0x0Fu) | (opcode >> 5 & 0x30u));
      return make(opcode & 0x800u ? Code::out : Code::in, register_d(opcode), 0, 1, port);
    }
    case 0xC: return make(Code::jump, 0, 0, 2, relative(12, 0));
    case 0xD: return make(Code::call, 1, 0, wide_pc_ ? 4 : 3, relative(12, 0));
    case 0xE: return make(Code::ldi, upper_register_d(opcode), 0, 1, constant_k(opcode));
    default: break;
  }
  const unsigned bit = opcode & 7u;
  switch (opcode >> 9 & 7u) {
    case 0:
    case 1:
    case 2:
    case 3:
      return make(static_cast<Code>(static_cast<unsigned>(Code::branch_by_carry) + bit), !(opcode & 0x400u), 0, 1,
                  relative(7, 3));
    case 4: return make(Code::bld, register_d(opcode), bit);
    case 5: return make(Code::bst, register_d(opcode), bit);
    case 6: return make(Code::sbrc, register_d(opcode), bit, 1, skip_length(address + 1));
    default: return make(Code::sbrs, register_d(opcode), bit, 1, skip_length(address + 1));  // erased flash too
  }
}

Instruction Decoder::decode_two_registers(unsigned opcode, uint32_t address) const {
  const unsigned d = register_d(opcode), r = register_r(opcode);
  switch (opcode >> 10) {
    case 0x1: return make(Code::cpc, d, r);
    case 0x2: return make(Code::sbc, d, r);
    case 0x3: return make(Code::add, d, r);
    case 0x4: return make(Code::cpse, d, r, 1, skip_length(address + 1));
    case 0x5: return make(Code::cp, d, r);
    case 0x6: return make(Code::sub, d, r);
    case 0x7: return make(Code::adc, d, r);
    case 0x8: return make(Code::logic_and, d, r);
    case 0x9: return make(Code::logic_xor, d, r);
    case 0xA: return make(Code::logic_or, d, r);
    case 0xB: return make(Code::mov, d, r);
    default: return decode_multiply(opcode);
  }
}

// 0000 00xx: NOP, MOVW and the multiplications of signed and fractional numbers.
Instruction Decoder::decode_multiply(unsigned opcode) const {
  switch (opcode >> 8) {
    case 0: return make(opcode == 0 ? Code::nop : Code::invalid);
    case 1: return make(Code::movw, opcode >> 3 & 0x1Eu, opcode << 1 & 0x1Eu);
    case 2: return make(Code::muls, upper_register_d(opcode), 16 + (opcode & 0x0Fu), 2);
    default: break;
  }
  const unsigned d = 16 + (opcode >> 4 & 7u), r = 16 + (opcode & 7u);
  switch (opcode & 0x88u) {
    case 0x00: return make(Code::mulsu, d, r, 2);
    case 0x08: return make(Code::fmul, d, r, 2);
    case 0x80: return make(Code::fmuls, d, r, 2);
    default: return make(Code::fmulsu, d, r, 2);
  }
}

// 1001 00xd dddd oooo: loads, and with x = 1 stores.
Instruction Decoder::decode_load_store(unsigned opcode, uint32_t address) const {
  const unsigned d = register_d(opcode);
  const bool is_store = opcode & 0x200u;
  const auto memory = [&](Code load, Code store, unsigned pointer) {
    return make(is_store ? store : load, d, pointer, 2);
  };
  switch (opcode & 0x0Fu) {
    case 0x0: return make(is_store ? Code::store_direct : Code::load_direct, d, 0, 2, word(address + 1));
    case 0x1: return memory(Code::load_increment, Code::store_increment, pointer_z);
    case 0x2: return memory(Code::load_decrement, Code::store_decrement, pointer_z);
    case 0x9: return memory(Code::load_increment, Code::store_increment, pointer_y);
    case 0xA: return memory(Code::load_decrement, Code::store_decrement, pointer_y);
    case 0xC: return memory(Code::load, Code::store, pointer_x);
    case 0xD: return memory(Code::load_increment, Code::store_increment, pointer_x);
    case 0xE: return memory(Code::load_decrement, Code::store_decrement, pointer_x);
    case 0xF: return make(is_store ? Code::push : Code::pop, d, 0, 2);
    case 0x4: return make(is_store ? Code::invalid : Code::lpm, d, 0, 3);
    case 0x5: return make(is_store ? Code::invalid : Code::lpm_increment, d, 0, 3);
    case 0x6: return make(is_store || !wide_pc_ ? Code::invalid : Code::elpm, d, 0, 3);
    case 0x7: return make(is_store || !wide_pc_ ? Code::invalid : Code::elpm_increment, d, 0, 3);
    default: return make(Code::invalid);
  }
}

// 1001 010d dddd oooo: one register, far jumps, and everything without operands.
Instruction Decoder::decode_one_register(unsigned opcode, uint32_t address) const {
  const unsigned d = register_d(opcode);
  const uint32_t target = ((opcode >> 3 & 0x3Eu) | (opcode & 1u)) << 16 | word(address + 1);
  switch (opcode & 0x0Fu) {
    case 0x0: return make(Code::com, d);
    case 0x1: return make(Code::neg, d);
    case 0x2: return make(Code::swap, d);
    case 0x3: return make(Code::inc, d);
    case 0x5: return make(Code::asr, d);
    case 0x6: return make(Code::lsr, d);
    case 0x7: return make(Code::ror, d);
    case 0x8: return decode_miscellaneous(opcode);
    case 0x9: return decode_miscellaneous(opcode);
    case 0xA: return make(Code::dec, d);
    case 0xC:
    case 0xD: return make(Code::jump, 0, 0, 3, target & mask_);
    case 0xE:
    case 0xF: return make(Code::call, 2, 0, wide_pc_ ? 5 : 4, target & mask_);
    default: return make(Code::invalid);
  }
}

Instruction Decoder::decode_miscellaneous(unsigned opcode) const {
  if ((opcode & 0xFF8Fu) == 0x9408u) return make(Code::bset, 0, opcode >> 4 & 7u);
  if ((opcode & 0xFF8Fu) == 0x9488u) return make(Code::bclr, 0, opcode >> 4 & 7u);
  switch (opcode) {
    case 0x9409: return make(Code::ijmp, 0, 0, 2);
    case 0x9419: return make(wide_pc_ ? Code::eijmp : Code::invalid, 0, 0, 2);
    case 0x9509: return make(Code::icall, 1, 0, wide_pc_ ? 4 : 3);
    case 0x9519: return make(wide_pc_ ? Code::eicall : Code::invalid, 1, 0, 4);
    case 0x9508: return make(Code::ret, 0, 0, wide_pc_ ? 5 : 4);
    case 0x9518: return make(Code::reti, 0, 0, wide_pc_ ? 5 : 4);
    case 0x9588: return make(Code::sleep);
    case 0x9598: return make(Code::nop);  // BREAK, with no debugger attached
    case 0x95A8: return make(Code::wdr);
    case 0x95C8: return make(Code::lpm, 0, 0, 3);
    case 0x95D8: return make(wide_pc_ ? Code::elpm : Code::invalid, 0, 0, 3);
    case 0x95E8: return make(Code::spm);
    default: return make(Code::invalid);
  }
}

// 1001 10oo AAAA Abbb
Instruction Decoder::decode_io_bit(unsigned opcode, uint32_t address) const {
  const uint32_t port = 0x20u + (opcode >> 3 & 0x1Fu);
  const unsigned mask = 1u << (opcode & 7u);
  const unsigned skipped = skip_length(address + 1);
  switch (opcode >> 8 & 3u) {
    case 0: return make(Code::cbi, 0, mask, 2, port);
    case 1: return make(Code::sbic, skipped, mask, 1, port);
    case 2: return make(Code::sbi, 0, mask, 2, port);
    default: return make(Code::sbis, skipped, mask, 1, port);
  }
}

}  // namespace board
