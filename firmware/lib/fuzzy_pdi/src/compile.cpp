// Derives a joint's coefficients from its stored settings, or says why not. Runs when parameters are applied, never in the tick.
#include "fuzzy_pdi.h"

namespace fuzzy_pdi {
namespace {

constexpr int16_t unit = 16384;            // 1.0 in q14
constexpr int16_t least_width = 164;       // 0.01, rounded up
constexpr uint32_t largest_k = 64UL << 16;
constexpr uint32_t largest_ki = 1000UL << 16;
constexpr uint16_t largest_ku_mv = 30000;
constexpr uint8_t longest_period_ms = 50;
constexpr uint8_t kd_period_ms = 20;

struct Division {
  uint32_t quotient, remainder;
};

// (high * 2^32 + low) / divisor, for high < divisor < 2^31.
Division divide(uint32_t high, uint32_t low, uint32_t divisor) {
  for (uint8_t bit = 0; bit < 32; ++bit) {
    high = (high << 1) | (low >> 31);
    low <<= 1;
    if (high >= divisor) {
      high -= divisor;
      low |= 1;
    }
  }
  return {low, high};
}

// The ramp that reaches 1 at size = width * 2^14 / gain: gain in q16, width in q14, both times the same number of milliseconds.
Ramp make_ramp(uint32_t width, uint32_t gain) {
  if (gain == 0) return {0, 0xFFFF};
  Ramp ramp = {0, 0xFFFF};
  if (width < 4 * gain) {
    const Division full = divide(width >> 18, width << 14, gain);
    ramp.last = static_cast<uint16_t>(full.remainder == 0 ? full.quotient - 1 : full.quotient);
  }
  if (ramp.last == 0) return ramp;  // full at size 1: only size 0 is ever multiplied
  // slope = one * 2^16 / full size, one = 2^24 - 1; or 2^8 for a short ramp.
  const uint32_t divisor = ramp.last < 256 ? width << 8 : width;
  const uint32_t take = gain << 2;
  const uint32_t low = gain << 26;
  const uint32_t high = (gain >> 6) - (low < take ? 1 : 0);
  const Division slope = divide(high, low - take, divisor);
  ramp.slope = slope.quotient + (slope.remainder >= divisor - slope.remainder ? 1 : 0);
  return ramp;
}

Refusal check_sets(const int16_t (&negative)[4], const int16_t (&positive)[4]) {
  for (uint8_t i = 0; i < 4; ++i) {
    if (negative[i] < -unit || positive[i] > unit) return Refusal::range;
    if (negative[i] >= 0 || positive[i] <= 0) {
      // A set on the other side of zero is out of order, however far; exactly 0 is a set without width.
      if (negative[i] > unit || positive[i] < -unit) return Refusal::range;
      return (negative[i] > 0 || positive[i] < 0) ? Refusal::order : Refusal::width;
    }
    if (negative[i] > -least_width || positive[i] < least_width) return Refusal::width;
  }
  return Refusal::none;
}

}  // namespace

Refusal compile(const Settings& s, uint8_t period_ms, Coefficients& out) {
  if (period_ms < 1 || period_ms > longest_period_ms) return Refusal::period;
  const int16_t negative[4] = {s.ne_c, s.ze_a, s.nce_c, s.zce_a};
  const int16_t positive[4] = {s.pe_b, s.ze_c, s.pce_b, s.zce_c};
  const Refusal refusal = check_sets(negative, positive);
  if (refusal != Refusal::none) return refusal;
  if (s.kp > largest_k || s.kd > largest_k || s.ki > largest_ki || s.ku_mv > largest_ku_mv) return Refusal::gain;
  if (s.ki > 0x1FFFFFFFUL / period_ms) return Refusal::gain;

  const uint32_t kd = s.kd * kd_period_ms;
  Coefficients made;
  for (uint8_t side = 0; side < 2; ++side) {
    const uint16_t outer_e = static_cast<uint16_t>(side == 0 ? positive[0] : -negative[0]);
    const uint16_t zero_e = static_cast<uint16_t>(side == 0 ? positive[1] : -negative[1]);
    const uint16_t outer_ce = static_cast<uint16_t>(side == 0 ? positive[2] : -negative[2]);
    const uint16_t zero_ce = static_cast<uint16_t>(side == 0 ? positive[3] : -negative[3]);
    made.e[side] = {make_ramp(zero_e, s.kp), make_ramp(outer_e, s.kp)};
    made.ce[side] = {make_ramp(uint32_t{zero_ce} * period_ms, kd), make_ramp(uint32_t{outer_ce} * period_ms, kd)};
  }
  made.integral = (s.ki * period_ms) << 3;
  made.ku_mv = s.ku_mv;
  out = made;
  return Refusal::none;
}

}  // namespace fuzzy_pdi
