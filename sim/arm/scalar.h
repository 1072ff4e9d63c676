// What the plant asks of its number type, so that the same equations run on double and on a vector of candidates.
#pragma once

// Lanes must not be passed to functions and back, as that costs more than most functions do.
#define GREYWHALE_INLINE inline __attribute__((always_inline))

namespace greywhale::arm {

// A constant in every lane. T may be a GCC vector type, which has no conversion from a number but does broadcast in
// sums.
template <class T>
constexpr T constant(double value) {
  return T{} + value;
}

// The wrapper around ?: that also takes a lane-wise mask (GCC's vector ?: needs vectors on both sides).
template <class Mask, class T>
GREYWHALE_INLINE T choose(Mask mask, T yes, T no) {
  return mask ? yes : no;
}

template <class T>
GREYWHALE_INLINE T absolute(T value) {
  return choose(value < constant<T>(0.0), -value, value);
}

// -1, 0 or +1, in the number type itself: sides and directions multiply straight into the equations.
template <class T>
GREYWHALE_INLINE T sign(T value) {
  const T zero = constant<T>(0.0);
  return choose(value > zero, constant<T>(1.0), choose(value < zero, constant<T>(-1.0), zero));
}

inline bool any(bool mask) { return mask; }
inline bool either(bool one, bool other) { return one || other; }

}  // namespace greywhale::arm
