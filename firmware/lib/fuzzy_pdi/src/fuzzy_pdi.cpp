// One control period of the fuzzy PD+I law.
#include "fuzzy_pdi.h"

#include "inference.h"

namespace fuzzy_pdi {
namespace {

constexpr int32_t integral_limit = int32_t{30000} << 15;

Input split(int16_t value) {
  return {static_cast<uint16_t>(value < 0 ? -value : value), value < 0};
}

int16_t saturate(int32_t value) {
  return static_cast<int16_t>(value > 32767 ? 32767 : value < -32767 ? -32767 : value);
}

// The integral after one more period of e, held within what any supply can give.
State integrate(const State& state, uint32_t factor, const Input& e) {
  const Product step = multiply(e.size, factor);
  State next = state;
  const uint16_t down = e.negative ? step.fraction : 0;
  const uint16_t up = e.negative ? 0 : step.fraction;
  next.fraction = static_cast<uint16_t>(state.fraction + up - down);
  const uint32_t whole = step.whole + (e.negative ? state.fraction < down : next.fraction < up);
  const uint32_t room = static_cast<uint32_t>(e.negative ? state.integral + integral_limit : integral_limit - state.integral);
  if (whole >= room) {
    next.integral = e.negative ? -integral_limit : integral_limit;
    next.fraction = 0;
  } else {
    next.integral = e.negative ? state.integral - static_cast<int32_t>(whole) : state.integral + static_cast<int32_t>(whole);
  }
  return next;
}

}  // namespace

void reset(State& state) { state = {0, 0, 0, false}; }

Output step(const Coefficients& c, State& state, int16_t leader_q12, int16_t follower_q12, uint16_t limit_mv) {
  const int16_t error = saturate(int32_t{leader_q12} - follower_q12);
  const int16_t change = state.started ? saturate(int32_t{error} - state.previous_e) : int16_t{0};
  const Input e = split(error);
  const Defuzzified u = infer(c, e, split(change));
  const bool down = (e.negative != u.flip) && u.size != 0;

  const uint32_t drive = static_cast<uint32_t>(u.size) * c.ku_mv;
  const int32_t proportional = down ? -static_cast<int32_t>(drive) : static_cast<int32_t>(drive);
  const int32_t limit = limit_mv > 32767 ? 32767 : limit_mv;

  State next = integrate(state, c.integral, e);
  int32_t volts = (proportional + next.integral + (int32_t{1} << 14)) >> 15;
  const bool beyond = volts > limit || volts < -limit;
  if (beyond && (volts < 0) == e.negative) {
    next = state;
    volts = (proportional + next.integral + (int32_t{1} << 14)) >> 15;
  }
  next.previous_e = error;
  next.started = true;
  state = next;
  volts = volts > limit ? limit : volts < -limit ? -limit : volts;

  const int16_t size = static_cast<int16_t>(u.size > 32767 ? 32767 : u.size);
  return {static_cast<int16_t>(down ? -size : size), static_cast<int16_t>(volts), beyond, u.no_rule};
}

}  // namespace fuzzy_pdi
