// Derives a joint's coefficients from its stored settings, or says why it cannot. It runs when parameters are applied,
// never in the tick.
#include "fuzzy_pdi.h"

namespace fuzzy_pdi {
namespace {

constexpr int16_t unit = 16384;       // 1.0 in q14
constexpr int16_t least_width = 164;  // 0.01, rounded up
constexpr uint32_t largest_k = 64UL << 16;
constexpr uint32_t largest_ki = 1000UL << 16;
constexpr uint32_t largest_ki_period = 1UL << 28;  // 4096 V ms / (rad s): a step of the integral stays below 2^30
constexpr uint16_t largest_ku_mv = 30000;
constexpr uint8_t longest_period_ms = 50;
constexpr uint8_t kd_span_ms = 20;

constexpr uint32_t largest_slope = 0xFFFFFFFF;

// round((high * 2^32 + low) / divisor), half up, at most largest_slope. divisor < 2^31.
uint32_t divide(uint32_t high, uint32_t low, uint32_t divisor) {
  if (high >= divisor) return largest_slope;
  for (uint8_t bit = 0; bit < 32; ++bit) {
    high = (high << 1) | (low >> 31);
    low <<= 1;
    if (high >= divisor) {
      high -= divisor;
      low |= 1;
    }
  }
  return low + ((high >= divisor - high && low != largest_slope) ? 1 : 0);
}

// A ramp is full at size width * 2^14 / gain (width in q14, gain in q16, or both times the same factor). Its slope is
// (2^24 - 1) * 2^16 / full size: what these 64 bits are, (2^24 - 1) * 4 gain, divided by the width.
struct Rise {
  uint32_t high, low;
  explicit Rise(uint32_t gain) : high(gain >> 6), low(gain << 26) {
    const uint32_t below = gain << 2;
    if (low < below) --high;
    low -= below;
  }
  uint32_t slope(uint32_t width) const { return divide(high, low, width); }
  // Full within the first 2^8 sizes, or within the first 2^7.
  bool is_short(uint32_t width) const { return high >= width; }
  bool is_very_short(uint32_t width) const { return high >= width << 1; }
};

// A rising ramp needs relative precision only: 24 bits of slope, in the upper three bytes unless the slope is below
// 2^24.
uint32_t without_low_byte(uint32_t slope) {
  if (slope < (uint32_t{1} << 24)) return slope;
  return (slope > largest_slope - 128 ? largest_slope : slope + 128) & ~uint32_t{0xFF};
}

void make_side(uint32_t zero_width, uint32_t outer_width, uint32_t gain, Side& out) {
  const Rise rise(gain);
  const bool outer_short = rise.is_short(outer_width);
  uint8_t ramps = 0, finer = 0;
  if (rise.is_very_short(zero_width)) {
    ramps = zero_is_short;
    finer = 8;
  } else if (rise.is_short(zero_width)) {
    ramps = zero_is_medium;
    finer = 1;
  }
  out.zero = rise.slope(zero_width << finer);
  out.outer = without_low_byte(rise.slope(outer_short ? outer_width << 8 : outer_width));
  out.short_ramps = static_cast<uint8_t>(ramps | (outer_short ? outer_is_short : 0));
}

// outward: a set's width, counted away from zero on its own side.
Refusal check_width(int32_t outward) {
  if (outward < -unit || outward > unit) return Refusal::range;
  if (outward < 0) return Refusal::order;
  return outward < least_width ? Refusal::width : Refusal::none;
}

Refusal check_pair(int16_t left, int16_t right) {
  const Refusal refusal = check_width(-int32_t{left});
  return refusal != Refusal::none ? refusal : check_width(right);
}

Refusal check_sets(const Settings& s) {
  Refusal refusal = check_pair(s.ne_c, s.pe_b);
  if (refusal == Refusal::none) refusal = check_pair(s.ze_a, s.ze_c);
  if (refusal == Refusal::none) refusal = check_pair(s.nce_c, s.pce_b);
  if (refusal == Refusal::none) refusal = check_pair(s.zce_a, s.zce_c);
  return refusal;
}

Refusal check_gains(const Settings& s, uint8_t period_ms) {
  if (s.kp > largest_k || s.kd > largest_k || s.ki > largest_ki || s.ku_mv > largest_ku_mv) return Refusal::gain;
  return s.ki * period_ms >= largest_ki_period ? Refusal::gain : Refusal::none;
}

uint32_t width(int value, uint16_t span_ms) { return static_cast<uint32_t>(value) * span_ms; }

}  // namespace

#ifdef __AVR__
__attribute__((noinline, noclone))  // the tests call this function in the image
#endif
Refusal compile(const Settings& s, uint8_t period_ms, Coefficients& out) {
  if (period_ms < 1 || period_ms > longest_period_ms) return Refusal::period;
  if (s.ce_ticks < 1 || s.ce_ticks > most_ce_ticks) return Refusal::range;
  Refusal refusal = check_sets(s);
  if (refusal == Refusal::none) refusal = check_gains(s, period_ms);
  if (refusal != Refusal::none) return refusal;

  const uint32_t kd = s.kd * kd_span_ms;
  const auto span_ms = static_cast<uint16_t>(s.ce_ticks * period_ms);
  make_side(width(s.ze_c, 1), width(s.pe_b, 1), s.kp, out.e[0]);
  make_side(width(-s.ze_a, 1), width(-s.ne_c, 1), s.kp, out.e[1]);
  make_side(width(s.zce_c, span_ms), width(s.pce_b, span_ms), kd, out.ce[0]);
  make_side(width(-s.zce_a, span_ms), width(-s.nce_c, span_ms), kd, out.ce[1]);
  out.integral = (s.ki * period_ms) << 3;
  out.ku_mv = s.ku_mv;
  out.ce_ticks = s.ce_ticks;
  return Refusal::none;
}

}  // namespace fuzzy_pdi
