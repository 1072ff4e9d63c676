// SPDX-License-Identifier: GPL-3.0-or-later
// The arithmetic of the AVR: results and status flags. simavr keeps each flag in a byte of its own.
#pragma once

#include <cstdint>

#include "simavr.h"

namespace board {

class Alu {
 public:
  explicit Alu(uint8_t* flags) : flags_(flags) {}

  uint8_t add(unsigned a, unsigned b, unsigned carry) const {
    const unsigned sum = a + b + carry;
    set(S_H, (a ^ b ^ sum) >> 4);
    set(S_C, sum >> 8);
    set(S_V, (~(a ^ b) & (a ^ sum)) >> 7);
    return sign_and_zero(sum);
  }
  uint8_t subtract(unsigned a, unsigned b, unsigned borrow) const {
    const unsigned difference = a - b - borrow;
    set(S_H, (a ^ b ^ difference) >> 4);
    set(S_C, difference >> 8);
    set(S_V, ((a ^ b) & (a ^ difference)) >> 7);
    return sign_and_zero(difference);
  }
  // The further bytes of a wide number: zero only if the bytes before were.
  uint8_t subtract_with_borrow(unsigned a, unsigned b) const {
    const uint8_t zero_before = flags_[S_Z];
    const uint8_t difference = subtract(a, b, flags_[S_C]);
    flags_[S_Z] &= zero_before;
    return difference;
  }
  uint8_t logic(unsigned result) const {
    flags_[S_V] = 0;
    return sign_and_zero(result);
  }
  uint8_t complement(unsigned a) const {
    flags_[S_C] = 1;
    return logic(~a);
  }
  uint8_t increment(unsigned a) const {
    flags_[S_V] = a == 0x7F;
    return sign_and_zero(a + 1);
  }
  uint8_t decrement(unsigned a) const {
    flags_[S_V] = a == 0x80;
    return sign_and_zero(a - 1);
  }
  // What is left of a after a shift to the right, with the bit that comes in from the left.
  uint8_t shift_right(unsigned a, unsigned top_bit) const {
    const unsigned result = a >> 1 | top_bit << 7;
    set(S_C, a);
    set(S_V, top_bit ^ a);
    return sign_and_zero(result);
  }
  uint16_t add_word(unsigned a, unsigned b) const {
    const unsigned sum = a + b;
    set(S_V, (~a & sum) >> 15);
    set(S_C, (~sum & a) >> 15);
    return sign_and_zero_word(sum);
  }
  uint16_t subtract_word(unsigned a, unsigned b) const {
    const unsigned difference = a - b;
    set(S_V, (a & ~difference) >> 15);
    set(S_C, (difference & ~a) >> 15);
    return sign_and_zero_word(difference);
  }
  // A product, shifted to the left by one for fractional numbers; the carry is the bit above.
  uint16_t product(int value, bool fractional) const {
    const auto bits = static_cast<unsigned>(value);
    set(S_C, bits >> 15);
    const auto result = static_cast<uint16_t>(fractional ? bits << 1 : bits);
    flags_[S_Z] = result == 0;
    return result;
  }

 private:
  void set(unsigned flag, unsigned lowest_bit) const { flags_[flag] = static_cast<uint8_t>(lowest_bit & 1u); }
  uint8_t sign_and_zero(unsigned result) const {
    const auto value = static_cast<uint8_t>(result);
    flags_[S_Z] = value == 0;
    flags_[S_N] = static_cast<uint8_t>(value >> 7);
    flags_[S_S] = flags_[S_N] ^ flags_[S_V];
    return value;
  }
  uint16_t sign_and_zero_word(unsigned result) const {
    const auto value = static_cast<uint16_t>(result);
    flags_[S_Z] = value == 0;
    flags_[S_N] = static_cast<uint8_t>(value >> 15);
    flags_[S_S] = flags_[S_N] ^ flags_[S_V];
    return value;
  }

  uint8_t* flags_;
};

}  // namespace board
