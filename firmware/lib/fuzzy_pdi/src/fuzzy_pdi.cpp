// One control period of the fuzzy PD+I law.
#include "fuzzy_pdi.h"

#include <stddef.h>

#include "inference.h"

namespace fuzzy_pdi {

void reset(const Coefficients& c, State& state, int32_t integral) { state = {integral, 0, c.ce_ticks, 0, {}}; }

#if defined(__AVR__) && !defined(FUZZY_PDI_PORTABLE)

// Every place that the assembly reads or writes.
static_assert(sizeof(Side) == 9 && offsetof(Side, zero) == 0 && offsetof(Side, outer) == 4 &&
                  offsetof(Side, short_ramps) == 8,
              "memberships_avr.inc");
static_assert(offsetof(Coefficients, e) == 0 && offsetof(Coefficients, ce) == 18 &&
                  offsetof(Coefficients, integral) == 36 && offsetof(Coefficients, ku_mv) == 40 &&
                  offsetof(Coefficients, ce_ticks) == 42,
              "step_avr.S");
static_assert(offsetof(State, integral) == 0 && offsetof(State, fraction) == 4 && offsetof(State, until_change) == 6 &&
                  offsetof(State, oldest) == 7 && offsetof(State, errors) == 8,
              "step_avr.S");
static_assert(offsetof(Joint, coefficients) == 0 && offsetof(Joint, state) == 43, "step_avr.S");
static_assert(sizeof(Output) == 6 && offsetof(Output, u_fuzzy) == 0 && offsetof(Output, volts_mv) == 2 &&
                  offsetof(Output, saturated) == 4 && offsetof(Output, no_rule) == 5,
              "returned in r18..r23");

#else

namespace {

constexpr int32_t integral_end = int32_t{1} << 30;

inline Input split(int16_t value) { return {static_cast<uint16_t>(value < 0 ? -value : value), value < 0}; }

// The error's change over c.ce_ticks control periods.
inline int16_t change_of(const Coefficients& c, State& state, int16_t error) {
  int16_t& place = state.errors[state.oldest];
  const int16_t before = place;
  place = error;
  if (++state.oldest >= c.ce_ticks) state.oldest = 0;
  if (state.until_change == 0) return difference(error, before);
  --state.until_change;
  return 0;
}

// Takes one more period of e into the integral.
inline void integrate(State& state, uint32_t factor, const Input& e) {
  const Product more = multiply(e.size, factor);
  const uint16_t before = state.fraction;
  if (e.negative) {
    state.fraction = static_cast<uint16_t>(before - more.fraction);
    state.integral -= static_cast<int32_t>(more.whole) + (before < more.fraction);
  } else {
    state.fraction = static_cast<uint16_t>(before + more.fraction);
    state.integral += static_cast<int32_t>(more.whole) + (state.fraction < before);
  }
  if (state.integral >= integral_end) {
    state.integral = integral_end - 1;
    state.fraction = 0xFFFF;
  } else if (state.integral < -integral_end) {
    state.integral = -integral_end;
    state.fraction = 0;
  }
}

struct Volts {
  uint16_t size_mv;
  bool negative;
};

// Rounded to mV, half away from zero.
inline Volts sum(int32_t proportional, int32_t integral) {
  const int32_t total = proportional + integral;
  const uint32_t size = static_cast<uint32_t>(total < 0 ? -total : total);
  return {static_cast<uint16_t>((size * 2 + 0x8000) >> 16), total < 0};
}

}  // namespace

Output step_error(const Coefficients& c, State& state, int16_t error_q12, uint16_t limit_mv) {
  const Input e = split(error_q12);
  const Defuzzified u = infer(c, e, split(change_of(c, state, error_q12)));
  const bool down = e.negative != u.flip;
  const int32_t drive = static_cast<int32_t>(static_cast<uint32_t>(u.size) * c.ku_mv);  // 2^-15 mV
  const int32_t proportional = down ? -drive : drive;

  const int32_t integral = state.integral;
  const uint16_t fraction = state.fraction;
  integrate(state, c.integral, e);
  Volts volts = sum(proportional, state.integral);
  const bool saturated = volts.size_mv > limit_mv;
  if (saturated && volts.negative == e.negative) {
    state.integral = integral;
    state.fraction = fraction;
    volts = sum(proportional, state.integral);
  }
  if (volts.size_mv > limit_mv) volts.size_mv = limit_mv;

  const int16_t size = static_cast<int16_t>(u.size > 32767 ? 32767 : u.size);
  const int16_t size_mv = static_cast<int16_t>(volts.size_mv);
  return {static_cast<int16_t>(down ? -size : size), static_cast<int16_t>(volts.negative ? -size_mv : size_mv),
          saturated, u.no_rule};
}

#endif

}  // namespace fuzzy_pdi
