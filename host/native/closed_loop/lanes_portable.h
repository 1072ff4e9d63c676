// Sixteen lanes of single precision or 32-bit integers in GCC's vector types, which the compiler cuts into what registers there are.
// Conditions are lanes of all ones or zeros. The same operations with the same results as lanes_avx512.h.
#pragma once

#include <emmintrin.h>

#include <cstdint>
#include <cstring>

#define GREYWHALE_INLINE inline __attribute__((always_inline))

namespace greywhale::loop::lanes {

constexpr int kLanes = 16;

typedef float FloatBits __attribute__((vector_size(64)));
typedef std::int32_t IntBits __attribute__((vector_size(64)));
typedef std::uint32_t WordBits __attribute__((vector_size(64)));

struct Mask {
  IntBits v;
};
struct Float {
  FloatBits v;
};
struct Int {
  IntBits v;
};

GREYWHALE_INLINE Float all(float x) { return {FloatBits{} + x}; }
GREYWHALE_INLINE Int all(std::int32_t x) { return {IntBits{} + x}; }
GREYWHALE_INLINE Float load(const float* p) {
  Float a;
  std::memcpy(&a, p, sizeof a);
  return a;
}
GREYWHALE_INLINE Int load(const std::int32_t* p) {
  Int a;
  std::memcpy(&a, p, sizeof a);
  return a;
}
GREYWHALE_INLINE void store(float* p, Float a) { std::memcpy(p, &a, sizeof a); }
GREYWHALE_INLINE void store(std::int32_t* p, Int a) { std::memcpy(p, &a, sizeof a); }
GREYWHALE_INLINE WordBits words(Int a) { return reinterpret_cast<WordBits>(a.v); }
GREYWHALE_INLINE Int of_words(WordBits a) { return {reinterpret_cast<IntBits>(a)}; }

GREYWHALE_INLINE Mask operator<(Float a, Float b) { return {a.v < b.v}; }
GREYWHALE_INLINE Mask operator>(Float a, Float b) { return {a.v > b.v}; }
GREYWHALE_INLINE Mask operator>=(Float a, Float b) { return {a.v >= b.v}; }
GREYWHALE_INLINE Mask operator!=(Float a, Float b) { return {a.v != b.v}; }
GREYWHALE_INLINE Mask operator<(Int a, Int b) { return {a.v < b.v}; }
GREYWHALE_INLINE Mask operator>(Int a, Int b) { return {a.v > b.v}; }
GREYWHALE_INLINE Mask operator>=(Int a, Int b) { return {a.v >= b.v}; }
GREYWHALE_INLINE Mask operator!=(Int a, Int b) { return {a.v != b.v}; }
GREYWHALE_INLINE Mask negative(Int a) { return {a.v >> 31}; }

GREYWHALE_INLINE Mask operator&(Mask a, Mask b) { return {a.v & b.v}; }
GREYWHALE_INLINE Mask operator|(Mask a, Mask b) { return {a.v | b.v}; }
GREYWHALE_INLINE Mask operator^(Mask a, Mask b) { return {a.v ^ b.v}; }
GREYWHALE_INLINE Mask operator~(Mask a) { return {~a.v}; }
GREYWHALE_INLINE bool any(Mask a) {
  std::int64_t parts[8];
  std::memcpy(parts, &a, sizeof a);
  return (parts[0] | parts[1] | parts[2] | parts[3] | parts[4] | parts[5] | parts[6] | parts[7]) != 0;
}

GREYWHALE_INLINE Int choose(Mask m, Int yes, Int no) { return {(yes.v & m.v) | (no.v & ~m.v)}; }
GREYWHALE_INLINE Int bits_of(Float a) { return {reinterpret_cast<IntBits>(a.v)}; }
GREYWHALE_INLINE Float float_of_bits(Int a) { return {reinterpret_cast<FloatBits>(a.v)}; }
GREYWHALE_INLINE Float choose(Mask m, Float yes, Float no) { return float_of_bits(choose(m, bits_of(yes), bits_of(no))); }

GREYWHALE_INLINE Float operator+(Float a, Float b) { return {a.v + b.v}; }
GREYWHALE_INLINE Float operator-(Float a, Float b) { return {a.v - b.v}; }
GREYWHALE_INLINE Float operator*(Float a, Float b) { return {a.v * b.v}; }
GREYWHALE_INLINE Float operator/(Float a, Float b) { return {a.v / b.v}; }
GREYWHALE_INLINE Float least(Float a, Float b) { return choose(a < b, a, b); }
GREYWHALE_INLINE Float greatest(Float a, Float b) { return choose(a > b, a, b); }

GREYWHALE_INLINE Int operator+(Int a, Int b) { return of_words(words(a) + words(b)); }
GREYWHALE_INLINE Int operator-(Int a, Int b) { return of_words(words(a) - words(b)); }
GREYWHALE_INLINE Int operator*(Int a, Int b) { return of_words(words(a) * words(b)); }
GREYWHALE_INLINE Int operator&(Int a, Int b) { return {a.v & b.v}; }
GREYWHALE_INLINE Int operator^(Int a, Int b) { return {a.v ^ b.v}; }
GREYWHALE_INLINE Int least(Int a, Int b) { return choose(a < b, a, b); }
GREYWHALE_INLINE Int greatest(Int a, Int b) { return choose(a > b, a, b); }
GREYWHALE_INLINE Int absolute(Int a) { return choose(negative(a), all(0) - a, a); }
template <int N>
GREYWHALE_INLINE Int shift_left(Int a) {
  return of_words(words(a) << N);
}
template <int N>
GREYWHALE_INLINE Int shift_right(Int a) {  // of unsigned numbers
  return of_words(words(a) >> N);
}
template <int N>
GREYWHALE_INLINE Int shift_right_signed(Int a) {
  return {a.v >> N};
}
GREYWHALE_INLINE Int shift_left(Int a, Int by) { return of_words(words(a) << words(by)); }
GREYWHALE_INLINE Int shift_right(Int a, Int by) { return of_words(words(a) >> words(by)); }
GREYWHALE_INLINE Int shift_right_all(Int a, int by) { return of_words(words(a) >> static_cast<std::uint32_t>(by)); }

GREYWHALE_INLINE Float to_float(Int a) { return {__builtin_convertvector(a.v, FloatBits)}; }

// Not __builtin_convertvector and rint: these give what the processor's instruction gives for every number, NaN included.
template <class Convert>
GREYWHALE_INLINE Int in_quarters(Float a, Convert convert) {
  __m128 from[4];
  __m128i to[4];
  std::memcpy(from, &a, sizeof a);
  for (int i = 0; i < 4; ++i) to[i] = convert(from[i]);
  Int result;
  std::memcpy(&result, to, sizeof result);
  return result;
}
GREYWHALE_INLINE Int to_int(Float a) {  // towards 0
  return in_quarters(a, [](__m128 x) { return _mm_cvttps_epi32(x); });
}
GREYWHALE_INLINE Int to_nearest(Float a) {  // halves to even
  return in_quarters(a, [](__m128 x) { return _mm_cvtps_epi32(x); });
}

// Position of the highest bit set, 0..23, of numbers 1..2^24-1: they are exact in single precision.
GREYWHALE_INLINE Int highest_bit(Int a) { return shift_right<23>(bits_of(to_float(a))) - all(127); }

}  // namespace greywhale::loop::lanes
