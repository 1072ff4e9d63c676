// The upper half of a 16-bit product: how the tick divides. On AVR in assembly, because avr-gcc makes the whole product
// first. test/target/test_upper_product holds the two forms equal.
#pragma once
#include <stdint.h>

namespace signal_chain {

inline uint16_t upper_product_portable(uint16_t a, uint16_t b) {
  return static_cast<uint16_t>((static_cast<uint32_t>(a) * b) >> 16);
}

#ifdef __AVR__

inline __attribute__((always_inline)) uint16_t upper_product(uint16_t a, uint16_t b) {
  uint16_t product;
  uint8_t low, zero;
  __asm__(
      "clr %[zero]\n\t"
      "mul %A[a], %A[b]\n\t"
      "mov %[low], r1\n\t"
      "mul %B[a], %B[b]\n\t"
      "movw %A[product], r0\n\t"
      "mul %A[a], %B[b]\n\t"
      "add %[low], r0\n\t"
      "adc %A[product], r1\n\t"
      "adc %B[product], %[zero]\n\t"
      "mul %B[a], %A[b]\n\t"
      "add %[low], r0\n\t"
      "adc %A[product], r1\n\t"
      "adc %B[product], %[zero]\n\t"
      "clr r1"
      : [product] "=&r"(product), [low] "=&r"(low), [zero] "=&r"(zero)
      : [a] "r"(a), [b] "r"(b));
  return product;
}

#else

inline uint16_t upper_product(uint16_t a, uint16_t b) { return upper_product_portable(a, b); }

#endif

}  // namespace signal_chain
