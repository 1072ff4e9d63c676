// From the two inputs to u_fuzzy: memberships, rules, defuzzification. On AVR memberships_avr.inc and rules_avr.inc
// replace it.
//
// Heights are 24-bit fractions of `one`. Each input is taken as size and sign: on either side of zero only two sets are
// active, so the nine rules of Table 6 become three (same signs) or four (opposite signs) minima.
#pragma once

#include "arithmetic.h"
#include "fuzzy_pdi.h"

namespace fuzzy_pdi {

constexpr uint32_t one = 0xFFFFFF;  // membership 1.0; with this scale 1 - h is a complement

struct Input {
  uint16_t size;
  bool negative;
};

struct Memberships {
  uint32_t zero;   // ZE or ZCE
  uint32_t outer;  // PE or NE (PCE or NCE), whichever is on the input's side
};

// Heights of the output sets, seen from e's side: `with` is PU for e >= 0 and NU for e < 0, `against` the other.
struct Rules {
  uint32_t with, zero, against;
};

// A ramp from 0 at size 0 to 1: round(size * slope / 2^16), half up. A short ramp, full within the first 256 sizes, has
// a slope 2^8 times finer, so that every ramp keeps its precision. One of ZE or ZCE that is full within 129 to 256
// sizes is a medium one: its slope is twice as fine, and takes all 32 bits.
inline uint32_t climb(uint32_t slope, bool is_short, uint16_t size) {
  if (is_short) {
    if (size > 255) return one;
    size = static_cast<uint16_t>(size << 8);
  }
  const Product product = multiply(size, slope);
  const uint32_t height = product.whole + (product.fraction >> 15);
  return height > one ? one : height;
}

inline Memberships fuzzify(const Side& side, uint16_t size) {
  const auto of_zero = static_cast<uint16_t>(side.short_ramps & 4 ? size << 1 : size);
  return {one - climb(side.zero, side.short_ramps & 1, of_zero), climb(side.outer, side.short_ramps & 2, size)};
}

inline uint32_t lesser(uint32_t a, uint32_t b) { return a < b ? a : b; }
inline uint32_t greater(uint32_t a, uint32_t b) { return a < b ? b : a; }

inline Rules fire(const Memberships& e, const Memberships& ce, bool same_sign) {
  if (same_sign) {
    return {greater(lesser(e.zero, ce.outer), lesser(e.outer, greater(ce.zero, ce.outer))), lesser(e.zero, ce.zero), 0};
  }
  return {lesser(e.outer, ce.zero), greater(lesser(e.zero, ce.zero), lesser(e.outer, ce.outer)),
          lesser(e.zero, ce.outer)};
}

// Magnitude of u_fuzzy in q15 (32768 = 1.0); `flip` is set when it points against e.
struct Defuzzified {
  uint16_t size;
  bool flip;
  bool no_rule;
};

inline Defuzzified defuzzify(const Rules& rules) {
  const bool flip = rules.against > rules.with;
  const uint32_t part = flip ? rules.against - rules.with : rules.with - rules.against;
  const uint32_t whole = rules.with + rules.zero + rules.against;
  if (whole < 65536) return {0, false, true};  // nothing above 2^-8: impossible with sets as wide as compile() demands
  return {ratio_q15(part, whole), flip, false};
}

inline Defuzzified infer(const Coefficients& c, const Input& e, const Input& ce) {
  return defuzzify(
      fire(fuzzify(c.e[e.negative], e.size), fuzzify(c.ce[ce.negative], ce.size), e.negative == ce.negative));
}

}  // namespace fuzzy_pdi
