// The products that the tick is made of, on AVR in half the cycles of avr-gcc's library calls. On a computer they are written as
// what they mean; test/target/test_multiply compares the two on the chip.
#pragma once
#include <stdint.h>

namespace hal {

// 32 bits in two halves, because avr-gcc is clumsy with the upper half of a whole.
struct Offset {
  uint16_t low;
  int16_t high;
};

inline Offset make_offset(int32_t value) { return {static_cast<uint16_t>(value), static_cast<int16_t>(value >> 16)}; }

inline int32_t whole(Offset offset) { return static_cast<int32_t>(offset.high) * 0x10000 + offset.low; }

namespace portable {

// (old * keep + 128) / 256 + sum * gain, within 16 bits
inline uint16_t blend(uint16_t old, uint8_t keep, uint16_t sum, uint8_t gain) {
  return static_cast<uint16_t>(((static_cast<uint32_t>(old) * keep + 128) >> 8) + static_cast<uint32_t>(sum) * gain);
}

// (value * factor + offset) / 2^15, within 16 bits; value * factor + offset within 31 bits
inline int16_t line(uint16_t value, int16_t factor, Offset offset) {
  return static_cast<int16_t>((static_cast<int32_t>(value) * factor + whole(offset)) >> 15);
}

// The upper half of the product
inline uint16_t upper_product(uint16_t a, uint16_t b) {
  return static_cast<uint16_t>((static_cast<uint32_t>(a) * b) >> 16);
}

}  // namespace portable

#ifdef __AVR__

inline __attribute__((always_inline)) uint16_t blend(uint16_t old, uint8_t keep, uint16_t sum, uint8_t gain) {
  uint16_t result;
  __asm__("mul %A[old], %[keep]\n\t"
      "lsl r0\n\t"                  // its highest bit is the half that rounds up
      "mov %A[result], r1\n\t"
      "adc %A[result], %[zero]\n\t"
      "mul %B[old], %[keep]\n\t"
      "add %A[result], r0\n\t"
      "mov %B[result], r1\n\t"
      "adc %B[result], %[zero]\n\t"
      "mul %A[sum], %[gain]\n\t"
      "add %A[result], r0\n\t"
      "adc %B[result], r1\n\t"
      "mul %B[sum], %[gain]\n\t"
      "add %B[result], r0\n\t"
      "clr r1"
      : [result] "=&r"(result)
      : [old] "r"(old), [keep] "r"(keep), [sum] "r"(sum), [gain] "r"(gain), [zero] "r"(uint8_t{0}));
  return result;
}

inline __attribute__((always_inline)) int16_t line(uint16_t value, int16_t factor, Offset offset) {
  int16_t high = offset.high;
  uint16_t low = offset.low;
  __asm__("mul %A[value], %A[factor]\n\t"
      "add %A[low], r0\n\t"
      "adc %B[low], r1\n\t"
      "adc %A[high], %[zero]\n\t"
      "adc %B[high], %[zero]\n\t"
      "mul %B[value], %A[factor]\n\t"
      "add %B[low], r0\n\t"
      "adc %A[high], r1\n\t"
      "adc %B[high], %[zero]\n\t"
      "mulsu %B[factor], %A[value]\n\t"
      "sbc %B[high], %[zero]\n\t"    // the carry is the sign of a mixed product
      "add %B[low], r0\n\t"
      "adc %A[high], r1\n\t"
      "adc %B[high], %[zero]\n\t"
      "mulsu %B[factor], %B[value]\n\t"
      "add %A[high], r0\n\t"
      "adc %B[high], r1\n\t"
      "lsl %B[low]\n\t"
      "rol %A[high]\n\t"
      "rol %B[high]\n\t"
      "clr r1"
      : [high] "+&r"(high), [low] "+&r"(low)
      : [value] "a"(value), [factor] "a"(factor), [zero] "r"(uint8_t{0}));
  return high;
}

inline __attribute__((always_inline)) uint16_t upper_product(uint16_t a, uint16_t b) {
  uint16_t product;
  uint8_t low, zero;
  __asm__("clr %[zero]\n\t"
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

using portable::blend;
using portable::line;
using portable::upper_product;

#endif

}  // namespace hal
