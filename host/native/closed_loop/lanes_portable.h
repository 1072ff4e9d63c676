// Sixteen lanes of single precision or 32-bit integers, in as many of the compiler's vectors as the registers' width
// asks for. Conditions are lanes of all ones or zeros. The same operations with the same results as lanes_avx512.h.
#pragma once

#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <immintrin.h>
#endif

#include "arm/scalar.h"

namespace greywhale::loop::GREYWHALE_INSTRUCTIONS {

constexpr int kLanes = 16;
#ifdef __AVX2__
constexpr int kWidth = 32;  // bytes of a register
#else
constexpr int kWidth = 16;
#endif
constexpr int kParts = 64 / kWidth;

typedef float FloatPart __attribute__((vector_size(kWidth)));
typedef std::int32_t IntPart __attribute__((vector_size(kWidth)));
typedef std::uint32_t WordPart __attribute__((vector_size(kWidth)));

struct Mask {
  IntPart v[kParts];
};
struct Float {
  FloatPart v[kParts];
};
struct Int {
  IntPart v[kParts];
};

// A result of type T, part by part. Four parts stand without a loop and are inlined at once; the compiler would
// otherwise take four times as long to find that they fit in registers.
template <class T, class Operation>
GREYWHALE_INLINE T parts(const Operation& operation) {
#ifdef __AVX2__
#define GREYWHALE_AT_ONCE
  T result;
  for (int p = 0; p < kParts; ++p) result.v[p] = operation(p);
  return result;
#else
#define GREYWHALE_AT_ONCE __attribute__((always_inline))
  return {{operation(0), operation(1), operation(2), operation(3)}};
#endif
}
GREYWHALE_INLINE WordPart word(IntPart a) { return reinterpret_cast<WordPart>(a); }
GREYWHALE_INLINE IntPart of_word(WordPart a) { return reinterpret_cast<IntPart>(a); }

GREYWHALE_INLINE Float all(float x) {
  return parts<Float>([=](int) { return FloatPart{} + x; });
}
GREYWHALE_INLINE Int all(std::int32_t x) {
  return parts<Int>([=](int) { return IntPart{} + x; });
}
template <class T, class Number>
GREYWHALE_INLINE T loaded(const Number* from) {
  T a;
  std::memcpy(&a, from, sizeof a);
  return a;
}
GREYWHALE_INLINE Float load(const float* from) { return loaded<Float>(from); }
GREYWHALE_INLINE Int load(const std::int32_t* from) { return loaded<Int>(from); }
GREYWHALE_INLINE void store(float* to, Float a) { std::memcpy(to, &a, sizeof a); }
GREYWHALE_INLINE void store(std::int32_t* to, Int a) { std::memcpy(to, &a, sizeof a); }

#define GREYWHALE_COMPARE(sign, T)                                                   \
  GREYWHALE_INLINE Mask operator sign(T a, T b) {                                    \
    return parts<Mask>([&](int p) GREYWHALE_AT_ONCE { return a.v[p] sign b.v[p]; }); \
  }
GREYWHALE_COMPARE(<, Float)
GREYWHALE_COMPARE(>, Float)
GREYWHALE_COMPARE(>=, Float)
GREYWHALE_COMPARE(!=, Float)
GREYWHALE_COMPARE(<, Int)
GREYWHALE_COMPARE(>, Int)
GREYWHALE_COMPARE(>=, Int)
GREYWHALE_COMPARE(!=, Int)
#undef GREYWHALE_COMPARE

#define GREYWHALE_EXACT(sign, T)                                                  \
  GREYWHALE_INLINE T operator sign(T a, T b) {                                    \
    return parts<T>([&](int p) GREYWHALE_AT_ONCE { return a.v[p] sign b.v[p]; }); \
  }
GREYWHALE_EXACT(+, Float)
GREYWHALE_EXACT(-, Float)
GREYWHALE_EXACT(*, Float)
GREYWHALE_EXACT(/, Float)
GREYWHALE_EXACT(&, Int)
GREYWHALE_EXACT(^, Int)
GREYWHALE_EXACT(&, Mask)
GREYWHALE_EXACT(|, Mask)
GREYWHALE_EXACT(^, Mask)
#undef GREYWHALE_EXACT

// Modulo 2^32.
#define GREYWHALE_WRAPPING(sign)                                                                         \
  GREYWHALE_INLINE Int operator sign(Int a, Int b) {                                                     \
    return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return of_word(word(a.v[p]) sign word(b.v[p])); }); \
  }
GREYWHALE_WRAPPING(+)
GREYWHALE_WRAPPING(-)
GREYWHALE_WRAPPING(*)
#undef GREYWHALE_WRAPPING

GREYWHALE_INLINE Mask operator~(Mask a) {
  return parts<Mask>([&](int p) GREYWHALE_AT_ONCE { return ~a.v[p]; });
}
GREYWHALE_INLINE bool any(Mask a) {
  std::int64_t words[8];
  std::memcpy(words, &a, sizeof a);
  return (words[0] | words[1] | words[2] | words[3] | words[4] | words[5] | words[6] | words[7]) != 0;
}
GREYWHALE_INLINE Mask negative(Int a) {
  return parts<Mask>([&](int p) GREYWHALE_AT_ONCE { return a.v[p] < IntPart{}; });
}

GREYWHALE_INLINE Int bits_of(Float a) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return reinterpret_cast<IntPart>(a.v[p]); });
}
GREYWHALE_INLINE Float float_of_bits(Int a) {
  return parts<Float>([&](int p) GREYWHALE_AT_ONCE { return reinterpret_cast<FloatPart>(a.v[p]); });
}
GREYWHALE_INLINE Int choose(Mask m, Int yes, Int no) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return (yes.v[p] & m.v[p]) | (no.v[p] & ~m.v[p]); });
}
GREYWHALE_INLINE Float choose(Mask m, Float yes, Float no) {
  return float_of_bits(choose(m, bits_of(yes), bits_of(no)));
}
GREYWHALE_INLINE Float least(Float a, Float b) { return choose(a < b, a, b); }
GREYWHALE_INLINE Float greatest(Float a, Float b) { return choose(a > b, a, b); }
GREYWHALE_INLINE Int least(Int a, Int b) { return choose(a < b, a, b); }
GREYWHALE_INLINE Int greatest(Int a, Int b) { return choose(a > b, a, b); }
GREYWHALE_INLINE Int absolute(Int a) { return choose(negative(a), all(0) - a, a); }

template <int N>
GREYWHALE_INLINE Int shift_left(Int a) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return of_word(word(a.v[p]) << N); });
}
template <int N>
GREYWHALE_INLINE Int shift_right(Int a) {  // of unsigned numbers
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return of_word(word(a.v[p]) >> N); });
}
template <int N>
GREYWHALE_INLINE Int shift_right_signed(Int a) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return a.v[p] >> N; });
}
GREYWHALE_INLINE Int shift_left(Int a, Int by) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return of_word(word(a.v[p]) << word(by.v[p])); });
}
GREYWHALE_INLINE Int shift_right(Int a, Int by) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return of_word(word(a.v[p]) >> word(by.v[p])); });
}

GREYWHALE_INLINE Float to_float(Int a) {
  return parts<Float>([&](int p) GREYWHALE_AT_ONCE { return __builtin_convertvector(a.v[p], FloatPart); });
}
// Towards 0, of numbers that a lane can hold.
GREYWHALE_INLINE Int to_int(Float a) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return __builtin_convertvector(a.v[p], IntPart); });
}
// Halves to even. What is no number or does not fit is INT32_MIN, as x86's own instruction has it.
#ifdef __AVX2__
GREYWHALE_INLINE Int to_nearest(Float a) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return reinterpret_cast<IntPart>(_mm256_cvtps_epi32(a.v[p])); });
}
#elif defined(__SSE2__)
GREYWHALE_INLINE Int to_nearest(Float a) {
  return parts<Int>([&](int p) GREYWHALE_AT_ONCE { return reinterpret_cast<IntPart>(_mm_cvtps_epi32(a.v[p])); });
}
#else
GREYWHALE_INLINE Int to_nearest(Float a) {
  const Float size = float_of_bits(bits_of(a) & all(INT32_MAX));
  const Float whole = all(8388608.0f);  // 2^23: from here on all numbers are whole, so adding it rounds
  const Float rounded = choose(size < whole, (size + whole) - whole, size);
  const Mask fits = size < all(2147483648.0f);
  const Int result = to_int(choose(fits, rounded, all(0.0f)));
  return choose(fits, choose(negative(bits_of(a)), all(0) - result, result), all(INT32_MIN));
}
#endif

#ifdef __AVX2__
GREYWHALE_INLINE Int pick(const std::int32_t* from, Int places) {
  return parts<Int>([&](int p) {
    return reinterpret_cast<IntPart>(_mm256_i32gather_epi32(from, reinterpret_cast<__m256i>(places.v[p]), 4));
  });
}
#else
GREYWHALE_INLINE Int pick(const std::int32_t* from, Int places) {
  std::int32_t picked[16];
  for (int part = 0; part < kParts; ++part) {
    for (int n = 0; n < kWidth / 4; ++n) picked[part * kWidth / 4 + n] = from[places.v[part][n]];
  }
  return load(picked);
}
#endif

// Position of the highest bit set, 0..23, of numbers 1..2^24-1: they are exact in single precision.
GREYWHALE_INLINE Int highest_bit(Int a) { return shift_right<23>(bits_of(to_float(a))) - all(127); }

}  // namespace greywhale::loop::GREYWHALE_INSTRUCTIONS
