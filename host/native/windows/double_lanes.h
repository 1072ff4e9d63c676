// The arm's number type in lanes of double precision: as many as a vector of the instruction set has.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <cstddef>

#include "arm/scalar.h"

namespace greywhale::windows::GREYWHALE_INSTRUCTIONS {

#if defined(__AVX512F__)
constexpr std::size_t kLanes = 8;
#elif defined(__AVX2__)
constexpr std::size_t kLanes = 4;
#else
constexpr std::size_t kLanes = 2;
#endif

typedef double Vector __attribute__((vector_size(kLanes * sizeof(double))));

// A choice for each lane: a bit each, or lanes of all ones or zeros.
#ifdef __AVX512F__
struct Condition {
  __mmask8 v;
};
#else
struct Condition {
  decltype(Vector{} < Vector{}) v;
};
#endif

// A class of this namespace, so that all that the arm's templates become with it belongs to this namespace too.
struct Lanes {
  Vector v;

  Lanes() = default;  // cppcheck-suppress uninitMemberVar // open, as a double is
  GREYWHALE_INLINE Lanes(Vector lanes) : v(lanes) {}
  GREYWHALE_INLINE Lanes(double all) : v(Vector{} + all) {}
  double operator[](std::size_t lane) const { return v[lane]; }
  void set(std::size_t lane, double value) { v[lane] = value; }

  friend GREYWHALE_INLINE Lanes operator-(Lanes a) { return -a.v; }
  friend GREYWHALE_INLINE Lanes operator+(Lanes a, Lanes b) { return a.v + b.v; }
  friend GREYWHALE_INLINE Lanes operator-(Lanes a, Lanes b) { return a.v - b.v; }
  friend GREYWHALE_INLINE Lanes operator*(Lanes a, Lanes b) { return a.v * b.v; }
  friend GREYWHALE_INLINE Lanes operator/(Lanes a, Lanes b) { return a.v / b.v; }
#ifdef __AVX512F__
  template <int kHow>
  static GREYWHALE_INLINE Condition compare(Lanes a, Lanes b) {
    return {_mm512_cmp_pd_mask(a.v, b.v, kHow)};
  }
  friend GREYWHALE_INLINE Condition operator<(Lanes a, Lanes b) { return compare<_CMP_LT_OQ>(a, b); }
  friend GREYWHALE_INLINE Condition operator>(Lanes a, Lanes b) { return compare<_CMP_GT_OQ>(a, b); }
  friend GREYWHALE_INLINE Condition operator<=(Lanes a, Lanes b) { return compare<_CMP_LE_OQ>(a, b); }
  friend GREYWHALE_INLINE Condition operator>=(Lanes a, Lanes b) { return compare<_CMP_GE_OQ>(a, b); }
  friend GREYWHALE_INLINE Condition operator!=(Lanes a, Lanes b) { return compare<_CMP_NEQ_UQ>(a, b); }
#else
  friend GREYWHALE_INLINE Condition operator<(Lanes a, Lanes b) { return {a.v < b.v}; }
  friend GREYWHALE_INLINE Condition operator>(Lanes a, Lanes b) { return {a.v > b.v}; }
  friend GREYWHALE_INLINE Condition operator<=(Lanes a, Lanes b) { return {a.v <= b.v}; }
  friend GREYWHALE_INLINE Condition operator>=(Lanes a, Lanes b) { return {a.v >= b.v}; }
  friend GREYWHALE_INLINE Condition operator!=(Lanes a, Lanes b) { return {a.v != b.v}; }
#endif
};

#if defined(__AVX512F__)
GREYWHALE_INLINE Lanes choose(Condition mask, Lanes yes, Lanes no) { return _mm512_mask_blend_pd(mask.v, no.v, yes.v); }
GREYWHALE_INLINE Condition either(Condition one, Condition other) { return {static_cast<__mmask8>(one.v | other.v)}; }
GREYWHALE_INLINE bool any(Condition mask) { return mask.v != 0; }
#else
GREYWHALE_INLINE Lanes choose(Condition mask, Lanes yes, Lanes no) { return mask.v ? yes.v : no.v; }
GREYWHALE_INLINE Condition either(Condition one, Condition other) { return {one.v | other.v}; }
#ifdef __AVX2__
GREYWHALE_INLINE bool any(Condition mask) { return _mm256_movemask_pd(reinterpret_cast<__m256d>(mask.v)) != 0; }
#else
GREYWHALE_INLINE bool any(Condition mask) { return (mask.v[0] | mask.v[1]) != 0; }
#endif
#endif

}  // namespace greywhale::windows::GREYWHALE_INSTRUCTIONS
