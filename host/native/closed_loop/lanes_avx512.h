// Sixteen lanes of single precision or 32-bit integers in one AVX-512 register; conditions are mask registers. The same
// in the compiler's own vectors (lanes_portable.h) is a third slower, as it keeps conditions as numbers.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "arm/scalar.h"

namespace greywhale::loop::GREYWHALE_INSTRUCTIONS {

constexpr int kLanes = 16;

struct Mask {
  __mmask16 bits;
};
struct Float {
  __m512 v;
};
struct Int {
  __m512i v;
};

GREYWHALE_INLINE Float all(float x) { return {_mm512_set1_ps(x)}; }
GREYWHALE_INLINE Int all(std::int32_t x) { return {_mm512_set1_epi32(x)}; }
GREYWHALE_INLINE Float load(const float* p) { return {_mm512_loadu_ps(p)}; }
GREYWHALE_INLINE Int load(const std::int32_t* p) { return {_mm512_loadu_si512(p)}; }
GREYWHALE_INLINE void store(float* p, Float a) { _mm512_storeu_ps(p, a.v); }
GREYWHALE_INLINE void store(std::int32_t* p, Int a) { _mm512_storeu_si512(p, a.v); }

GREYWHALE_INLINE Float operator+(Float a, Float b) { return {_mm512_add_ps(a.v, b.v)}; }
GREYWHALE_INLINE Float operator-(Float a, Float b) { return {_mm512_sub_ps(a.v, b.v)}; }
GREYWHALE_INLINE Float operator*(Float a, Float b) { return {_mm512_mul_ps(a.v, b.v)}; }
GREYWHALE_INLINE Float operator/(Float a, Float b) { return {_mm512_div_ps(a.v, b.v)}; }
GREYWHALE_INLINE Float least(Float a, Float b) { return {_mm512_min_ps(a.v, b.v)}; }
GREYWHALE_INLINE Float greatest(Float a, Float b) { return {_mm512_max_ps(a.v, b.v)}; }
GREYWHALE_INLINE Int bits_of(Float a) { return {_mm512_castps_si512(a.v)}; }
GREYWHALE_INLINE Float float_of_bits(Int a) { return {_mm512_castsi512_ps(a.v)}; }

GREYWHALE_INLINE Int operator+(Int a, Int b) { return {_mm512_add_epi32(a.v, b.v)}; }
GREYWHALE_INLINE Int operator-(Int a, Int b) { return {_mm512_sub_epi32(a.v, b.v)}; }
GREYWHALE_INLINE Int operator*(Int a, Int b) { return {_mm512_mullo_epi32(a.v, b.v)}; }
GREYWHALE_INLINE Int operator&(Int a, Int b) { return {_mm512_and_si512(a.v, b.v)}; }
GREYWHALE_INLINE Int operator^(Int a, Int b) { return {_mm512_xor_si512(a.v, b.v)}; }
GREYWHALE_INLINE Int least(Int a, Int b) { return {_mm512_min_epi32(a.v, b.v)}; }
GREYWHALE_INLINE Int greatest(Int a, Int b) { return {_mm512_max_epi32(a.v, b.v)}; }
GREYWHALE_INLINE Int absolute(Int a) { return {_mm512_abs_epi32(a.v)}; }
template <int N>
GREYWHALE_INLINE Int shift_left(Int a) {
  return {_mm512_slli_epi32(a.v, N)};
}
template <int N>
GREYWHALE_INLINE Int shift_right(Int a) {  // of unsigned numbers
  return {_mm512_srli_epi32(a.v, N)};
}
template <int N>
GREYWHALE_INLINE Int shift_right_signed(Int a) {
  return {_mm512_srai_epi32(a.v, N)};
}
GREYWHALE_INLINE Int shift_left(Int a, Int by) { return {_mm512_sllv_epi32(a.v, by.v)}; }
GREYWHALE_INLINE Int shift_right(Int a, Int by) { return {_mm512_srlv_epi32(a.v, by.v)}; }

GREYWHALE_INLINE Float to_float(Int a) { return {_mm512_cvtepi32_ps(a.v)}; }
GREYWHALE_INLINE Int to_int(Float a) { return {_mm512_cvttps_epi32(a.v)}; }     // towards 0
GREYWHALE_INLINE Int to_nearest(Float a) { return {_mm512_cvtps_epi32(a.v)}; }  // halves to even

GREYWHALE_INLINE Mask operator<(Float a, Float b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ)}; }
GREYWHALE_INLINE Mask operator>(Float a, Float b) { return b < a; }
GREYWHALE_INLINE Mask operator>=(Float a, Float b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ)}; }
GREYWHALE_INLINE Mask operator!=(Float a, Float b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_NEQ_UQ)}; }
GREYWHALE_INLINE Mask operator<(Int a, Int b) { return {_mm512_cmplt_epi32_mask(a.v, b.v)}; }
GREYWHALE_INLINE Mask operator>(Int a, Int b) { return b < a; }
GREYWHALE_INLINE Mask operator>=(Int a, Int b) { return {_mm512_cmpge_epi32_mask(a.v, b.v)}; }
GREYWHALE_INLINE Mask operator!=(Int a, Int b) { return {_mm512_cmpneq_epi32_mask(a.v, b.v)}; }
GREYWHALE_INLINE Mask negative(Int a) { return {_mm512_movepi32_mask(a.v)}; }

GREYWHALE_INLINE Mask operator&(Mask a, Mask b) { return {_kand_mask16(a.bits, b.bits)}; }
GREYWHALE_INLINE Mask operator|(Mask a, Mask b) { return {_kor_mask16(a.bits, b.bits)}; }
GREYWHALE_INLINE Mask operator^(Mask a, Mask b) { return {_kxor_mask16(a.bits, b.bits)}; }
GREYWHALE_INLINE Mask operator~(Mask a) { return {_knot_mask16(a.bits)}; }
GREYWHALE_INLINE bool any(Mask a) { return a.bits != 0; }

GREYWHALE_INLINE Float choose(Mask m, Float yes, Float no) { return {_mm512_mask_blend_ps(m.bits, no.v, yes.v)}; }
GREYWHALE_INLINE Int choose(Mask m, Int yes, Int no) { return {_mm512_mask_blend_epi32(m.bits, no.v, yes.v)}; }

GREYWHALE_INLINE Int pick(const std::int32_t* from, Int places) { return {_mm512_i32gather_epi32(places.v, from, 4)}; }

// Position of the highest bit set, 0..23, of numbers 1..2^24-1.
GREYWHALE_INLINE Int highest_bit(Int a) { return all(31) - Int{_mm512_lzcnt_epi32(a.v)}; }

}  // namespace greywhale::loop::GREYWHALE_INSTRUCTIONS
