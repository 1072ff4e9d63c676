// Sine, cosine and logarithm of our own, so that an arm's bits hang on no library: IEEE 754 sums and products alone.
// Polynomials and split of pi/2 are those of fdlibm (Sun Microsystems, 1993; freely distributable); within 1.5 ulp
// where an arm moves.
#pragma once

#include <cmath>

#include "scalar.h"

namespace greywhale::arm {

namespace elementary {

// To the nearest whole number, for less than 2^51.
template <class T>
GREYWHALE_INLINE T round_to_whole(T value) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52: no fraction fits beside it
  return (value + constant<T>(kShift)) - constant<T>(kShift);
}

// A polynomial in z, the highest coefficient first.
template <class T>
GREYWHALE_INLINE T polynomial(T, double last) {
  return constant<T>(last);
}

template <class T, class... Rest>
GREYWHALE_INLINE T polynomial(T z, double lowest, Rest... rest) {
  return constant<T>(lowest) + z * polynomial(z, rest...);
}

}  // namespace elementary

// Of any angle in rad below 1e9.
template <class T>
GREYWHALE_INLINE void sine_cosine(T angle, T& sine, T& cosine) {
  using namespace elementary;
  constexpr double kTwoOverPi = 6.36619772367581382433e-01;
  // pi/2 in three parts; the first two have 33 bits, so that their products with a quarter turn's number are exact.
  constexpr double kFirst = 1.57079632673412561417e+00, kSecond = 6.07710050630396597660e-11,
                   kThird = 2.02226624879595063154e-21;
  const T quarter = round_to_whole(angle * constant<T>(kTwoOverPi));
  const T x =
      ((angle - quarter * constant<T>(kFirst)) - quarter * constant<T>(kSecond)) - quarter * constant<T>(kThird);
  const T z = x * x;
  const T s =
      x + x * z *
              polynomial(z, -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
                         2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10);
  const T half = constant<T>(0.5) * z;
  const T one = constant<T>(1.0);
  const T w = one - half;
  const T c = w + (((one - w) - half) + z * z *
                                            polynomial(z, 4.16666666666666019037e-02, -1.38888888888741095749e-03,
                                                       2.48015872894767294178e-05, -2.75573143513906633035e-07,
                                                       2.08757232129817482790e-09, -1.13596475577881948265e-11));
  // The quarter turn in -2 .. 2. Odd ones exchange the two, and each is negative in half of the turn.
  const T turn = quarter - constant<T>(4.0) * round_to_whole(quarter * constant<T>(0.25));
  const T side = absolute(turn);
  const T odd_s = choose(side < constant<T>(0.5), s, choose(side < constant<T>(1.5), c, s));
  const T odd_c = choose(side < constant<T>(0.5), c, choose(side < constant<T>(1.5), s, c));
  sine = choose(turn < constant<T>(-0.5), -odd_s, choose(turn < constant<T>(1.5), odd_s, -odd_s));
  cosine = choose(turn < constant<T>(-1.5), -odd_c, choose(turn < constant<T>(0.5), odd_c, -odd_c));
}

// Natural logarithm of a positive, normal number.
inline double logarithm(double value) {
  using namespace elementary;
  constexpr double kHigh = 6.93147180369123816490e-01, kLow = 1.90821492927058770002e-10;  // of log 2
  constexpr double kRootOfHalf = 0.70710678118654752440;
  int exponent;
  double m = std::frexp(value, &exponent);
  if (m < kRootOfHalf) {
    m *= 2.0;
    --exponent;
  }
  const double f = m - 1.0, s = f / (2.0 + f), z = s * s, half = 0.5 * f * f, k = exponent;
  const double r = z * polynomial(z, 6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01,
                                  2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01,
                                  1.479819860511658591e-01);
  return k * kHigh - ((half - (s * (half + r) + k * kLow)) - f);
}

// log(1 + x), also for small x > 0, within 2.5 ulp.
inline double logarithm_of_one_plus(double x) {
  const double sum = 1.0 + x;
  return sum > 1.0 ? logarithm(sum) * (x / (sum - 1.0)) : x;
}

}  // namespace greywhale::arm
