// Sine, cosine, logarithm and exponential without a C library, so that the arm moves and a search walks by the same
// bits wherever they are compiled. They add, subtract, multiply, divide and compare, which IEEE 754 rounds in one way
// only. Without branches a lane of a vector has the bits of a single number.
//
// The series are Taylor's, and what they leave out is less than 2^-58 of the result. tests/arm/test_elementary.py
// measures all errors.
#pragma once

#include <cstdint>
#include <cstring>

#include "scalar.h"

namespace greywhale::arm {

namespace detail {

// To the nearest whole number, below 2^51: so far up, a double has no bits for what is behind the point.
template <class T>
GREYWHALE_INLINE T rounded(T x) {
  constexpr double kWhole = 0x1.8p52;
  return (x + kWhole) - kWhole;
}

// Sine and cosine of r + rest within an eighth of a turn; the rest is less than a last bit or two of r.
template <class T>
GREYWHALE_INLINE void sine_cosine_near_zero(T r, T rest, T& sine, T& cosine) {
  const T z = r * r, zz = z * z, half = 0.5 * z;
  const T s = (-1.0 / 6.0 + z * (1.0 / 120.0)) + zz * (-1.0 / 5040.0 + z * (1.0 / 362880.0)) +
              zz * zz *
                  ((-1.0 / 39916800.0 + z * (1.0 / 6227020800.0)) +
                   zz * (-1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0)));
  const T c = (1.0 / 24.0 - z * (1.0 / 720.0)) + zz * (1.0 / 40320.0 - z * (1.0 / 3628800.0)) +
              zz * zz * ((1.0 / 479001600.0 - z * (1.0 / 87178291200.0)) + zz * (1.0 / 20922789888000.0));
  sine = r + (r * z * s + rest * (1.0 - half));
  const T most = 1.0 - half;
  cosine = most + (((1.0 - most) - half) + (zz * c - r * rest));  // with the bits that `most` has lost
}

}  // namespace detail

// Of an integer below 2^52: its bits become the last ones of 2^52. Not every processor converts a vector of integers.
GREYWHALE_INLINE double whole_number(std::uint64_t integer) {
  const std::uint64_t bits = integer | 0x433ull << 52;
  double raised;
  std::memcpy(&raised, &bits, sizeof raised);
  return raised - 0x1p52;
}

// Of an angle in rad: within 0.9 of the last bit up to 2^16 quarter turns; beyond, errors grow with the angle. NaN
// where it is not finite.
template <class T>
GREYWHALE_INLINE void sine_cosine(T angle, T& sine, T& cosine) {
  // A quarter turn in three parts (Cody and Waite): two of 33 bits, whose products with the number of quarter turns are
  // exact, and what is left.
  constexpr double kQuarter1 = 0x1.921fb544p+0, kQuarter2 = 0x1.0b4611a6p-34, kQuarter3 = 0x1.3198a2e037073p-69;
  constexpr double kQuartersPerRad = 0x1.45f306dc9c883p-1;
  const T quarters = detail::rounded(angle * kQuartersPerRad);
  const T nearly = angle - quarters * kQuarter1, second = quarters * kQuarter2;
  const T r = nearly - second;
  const T rest = ((nearly - r) - second) - quarters * kQuarter3;
  T s, c;
  detail::sine_cosine_near_zero(r, rest, s, c);

  // quarters = 4 n + 2 half + odd: a half turn changes both signs, an odd quarter, -1 or 1, swaps the two.
  const T halves = detail::rounded(0.5 * quarters), odd = quarters - 2.0 * halves;
  const T half = halves - 2.0 * detail::rounded(0.5 * halves);
  const T straight = (1.0 - 2.0 * (half * half)) * (1.0 - odd * odd);
  sine = straight * s + odd * c;
  cosine = straight * c - odd * s;
}

// Of two angles; for single numbers as one vector, which takes as long as one angle.
template <class Angle, class T>
GREYWHALE_INLINE void sines_cosines(Angle one, Angle other, T& sine1, T& cosine1, T& sine2, T& cosine2) {
  sine_cosine(one, sine1, cosine1);
  sine_cosine(other, sine2, cosine2);
}

GREYWHALE_INLINE void sines_cosines(double one, double other, double& sine1, double& cosine1, double& sine2,
                                    double& cosine2) {
  typedef double Both __attribute__((vector_size(2 * sizeof(double))));
  Both sines, cosines;
  sine_cosine(Both{one, other}, sines, cosines);
  sine1 = sines[0], cosine1 = cosines[0], sine2 = sines[1], cosine2 = cosines[1];
}

GREYWHALE_INLINE double sine(double angle) {
  double s, c;
  sine_cosine(angle, s, c);
  return s;
}

GREYWHALE_INLINE double cosine(double angle) {
  double s, c;
  sine_cosine(angle, s, c);
  return c;
}

// The natural logarithm of a normal number above 0, within the last bit.
GREYWHALE_INLINE double logarithm(double x) {
  constexpr double kLn2High = 0x1.62e42fee00000p-1, kLn2Low = 0x1.a39ef35793c76p-33;  // 32 bits, and the rest
  constexpr std::uint64_t kMantissa = (1ull << 52) - 1, kOne = 0x3ffull << 52;
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  const std::uint64_t unscaled = (bits & kMantissa) | kOne;
  double m;
  std::memcpy(&m, &unscaled, sizeof m);  // 1 to 2
  const bool large = m > 1.4142135623730951;
  m = large ? 0.5 * m : m;
  const double exponent = whole_number(bits >> 52) - 1023.0 + (large ? 1.0 : 0.0);

  // ln m = 2 artanh s = 2 s + s rest, and 2 s = f - s f, of which f has no error.
  const double f = m - 1.0, s = f / (m + 1.0), z = s * s, zz = z * z;
  const double rest = z * ((2.0 / 3.0 + z * (2.0 / 5.0)) + zz * (2.0 / 7.0 + z * (2.0 / 9.0)) +
                           zz * zz *
                               ((2.0 / 11.0 + z * (2.0 / 13.0)) + zz * (2.0 / 15.0 + z * (2.0 / 17.0)) +
                                zz * zz * (2.0 / 19.0 + z * (2.0 / 21.0))));
  return exponent * kLn2High + (f - (s * (f - rest) - exponent * kLn2Low));
}

// Of 1 + x, with the bits of x that the sum has lost, within 1.5 of the last bit; x not below 0.
inline double logarithm_of_1_and(double x) {
  const double sum = 1.0 + x;
  return logarithm(sum) + (x - (sum - 1.0)) / sum;
}

// e to the power of x, within 0.9 of the last bit from -708 to 709; beyond, as there.
inline double exponential(double x) {
  constexpr double kLn2High = 0x1.62e42fee00000p-1, kLn2Low = 0x1.a39ef35793c76p-33;
  constexpr double kPerLn2 = 0x1.71547652b82fep+0;
  const double bounded = x > 709.0 ? 709.0 : x > -708.0 ? x : -708.0;  // also where x is no number
  const double power = detail::rounded(bounded * kPerLn2);
  const double nearly = bounded - power * kLn2High, second = power * kLn2Low;
  const double r = nearly - second, rest = (nearly - r) - second;
  const double z = r * r, zz = z * z;
  const double tail =
      (0.5 + r * (1.0 / 6.0)) + z * (1.0 / 24.0 + r * (1.0 / 120.0)) +
      zz * ((1.0 / 720.0 + r * (1.0 / 5040.0)) + z * (1.0 / 40320.0 + r * (1.0 / 362880.0))) +
      zz * zz * ((1.0 / 3628800.0 + r * (1.0 / 39916800.0)) + z * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0)));
  const std::uint64_t bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(power) + 0x3ff) << 52;
  double scale;
  std::memcpy(&scale, &bits, sizeof scale);
  return scale * (1.0 + (r + (rest + z * tail)));
}

}  // namespace greywhale::arm
