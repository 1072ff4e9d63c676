// The arithmetic of the AVR: results and status flags. Most instructions set four flags or more and few look at one, so
// this keeps what the flags follow from, in three numbers that fit into a processor's registers.
#pragma once

#include <cstdint>

#include "mcu.h"

namespace board {

class Alu {
 public:
  explicit Alu(const uint8_t* flags) { load(flags); }

  // From and to the flags of SREG, each in a byte of its own. T and I stay there.
  void load(const uint8_t* flags) {
    carries_ = flags[flag::H] * half | flags[flag::C] * out | (flags[flag::C] ^ flags[flag::V]) * in;
    nonzero_ = !flags[flag::Z];
    sign_ = flags[flag::N] * negative_bit | (flags[flag::S] ^ flags[flag::N] ^ flags[flag::V]) * odd_sign;
  }
  void store(uint8_t* flags) const {
    flags[flag::C] = carry();
    flags[flag::Z] = zero();
    flags[flag::N] = negative();
    flags[flag::V] = overflow();
    flags[flag::S] = sign();
    flags[flag::H] = half_carry();
  }

  bool carry() const { return carries_ & out; }
  bool zero() const { return nonzero_ == 0; }
  bool negative() const { return sign_ & negative_bit; }
  bool overflow() const { return (carries_ ^ carries_ << 1) & out; }
  bool sign() const { return (sign_ ^ sign_ << 1 ^ carries_ ^ carries_ << 1) & out; }
  bool half_carry() const { return carries_ & half; }

  uint8_t add(unsigned a, unsigned b, unsigned carry) {
    const unsigned sum = a + b + carry;
    carries_ = a ^ b ^ sum;
    return sign_and_zero(sum);
  }
  uint8_t subtract(unsigned a, unsigned b, unsigned borrow) {
    const unsigned difference = a - b - borrow;
    carries_ = a ^ b ^ difference;
    return sign_and_zero(difference);
  }
  // The further bytes of a wide number: zero only if the bytes before were.
  uint8_t subtract_with_borrow(unsigned a, unsigned b) {
    const unsigned nonzero_before = nonzero_;
    const uint8_t difference = subtract(a, b, carry());
    nonzero_ |= nonzero_before;
    return difference;
  }
  uint8_t logic(unsigned result) {
    set_overflow(false);
    return sign_and_zero(result);
  }
  uint8_t complement(unsigned a) {
    carries_ |= out;
    return logic(~a);
  }
  uint8_t increment(unsigned a) {
    set_overflow(a == 0x7F);
    return sign_and_zero(a + 1);
  }
  uint8_t decrement(unsigned a) {
    set_overflow(a == 0x80);
    return sign_and_zero(a - 1);
  }
  // What is left of a after a shift to the right, with the bit that comes in from the left.
  uint8_t shift_right(unsigned a, unsigned top_bit) {
    set_carries(a << 8, top_bit << 7);
    return sign_and_zero(a >> 1 | top_bit << 7);
  }
  uint16_t add_word(unsigned a, unsigned b) {
    const unsigned sum = a + b;
    set_carries((a & ~sum) >> 7, (a ^ sum) >> 8);
    return sign_and_zero_word(sum);
  }
  uint16_t subtract_word(unsigned a, unsigned b) {
    const unsigned difference = a - b;
    set_carries((difference & ~a) >> 7, (a ^ difference) >> 8);
    return sign_and_zero_word(difference);
  }
  // A product, shifted to the left by one for fractional numbers; the carry is the bit above.
  uint16_t product(int value, bool fractional) {
    const auto bits = static_cast<unsigned>(value);
    const bool overflow_before = overflow();
    set_carries(bits >> 7, 0);
    set_overflow(overflow_before);
    const auto result = static_cast<uint16_t>(fractional ? bits << 1 : bits);
    nonzero_ = result;
    return result;
  }

 private:
  static constexpr unsigned half = 0x10, in = 0x80, out = 0x100;    // in carries_
  static constexpr unsigned negative_bit = 0x80, odd_sign = 0x100;  // in sign_

  void set_carries(unsigned carry_out, unsigned carry_in) {
    carries_ = (carries_ & half) | (carry_out & out) | (carry_in & in);
  }
  void set_overflow(bool overflow) { carries_ = (carries_ & (half | out)) | ((carries_ >> 1 ^ overflow * in) & in); }
  uint8_t sign_and_zero(unsigned result) {
    sign_ = nonzero_ = result & 0xFFu;
    return static_cast<uint8_t>(result);
  }
  uint16_t sign_and_zero_word(unsigned result) {
    nonzero_ = result & 0xFFFFu;
    sign_ = nonzero_ >> 8;
    return static_cast<uint16_t>(result);
  }

  unsigned carries_;  // into bit 4 (H), into bit 7, and out of it (C); the latter two differ in an overflow (V)
  unsigned nonzero_;  // Z, while it is 0
  unsigned sign_;     // N; and whether S is not what N and V make it, because the program has written SREG
};

}  // namespace board
