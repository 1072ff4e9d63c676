// The fuzzy PD+I law of one joint in fixed point: its settings, the coefficients derived from them, and one control
// period.
//
// Portable C++14: no heap, no float, no division outside compile(). docs/fuzzy.md derives formats, roundings and the
// error bound. A host twin (greywhale.fuzzy.twin) and a rational reference (greywhale.fuzzy.exact) pin every bit and
// the bound.
#pragma once

#include <codes/codes.h>
#include <stdint.h>

namespace fuzzy_pdi {

// One joint's controller as the parameter table stores it. Sets are q14 (16384 = 1.0) and named as in the paper: the
// end of NE's plateau, ZE's left and right foot, the start of PE's plateau, then the same for the change of error.
// Every other foot is 0.
struct Settings {
  int16_t ne_c, ze_a, ze_c, pe_b;
  int16_t nce_c, zce_a, zce_c, pce_b;
  uint32_t kp, kd, ki;  // q16; kd belongs to a change over 20 ms and is scaled by 20 / (ce_ticks period_ms)
  uint16_t ku_mv;       // volts at full output, in mV
  uint8_t ce_ticks;     // control periods that the change of error spans
};

constexpr uint8_t most_ce_ticks = 20;

// Why compile() refuses. `order` is kept by ne_c, ze_a, nce_c, zce_a < 0 < ze_c, pe_b, zce_c, pce_b.
using codes::Refusal;

// Bits of Side::short_ramps. Each has bit 7 too, so that the assembly finds them and small sizes by one comparison.
enum ShortRamp : uint8_t { zero_is_short = 0x81, outer_is_short = 0x82, zero_is_medium = 0x84 };

// One side of one input: slopes of the two sets active there. inference.h says what a slope is.
struct Side {
  uint32_t zero;        // how ZE (ZCE) falls from 1
  uint32_t outer;       // how PE, NE (PCE, NCE) rises to 1
  uint8_t short_ramps;  // bits of ShortRamp
};

// Everything the tick needs of one joint.
struct Coefficients {
  Side e[2];  // [0] for e >= 0, [1] for e < 0
  Side ce[2];
  uint32_t integral;  // 2^-31 mV per control period and 1/4096 rad
  uint16_t ku_mv;
  uint8_t ce_ticks;
};

// What one joint remembers between control periods.
struct State {
  int32_t integral;               // 2^-15 mV, held within +-2^15 mV
  uint16_t fraction;              // 2^-31 mV: nothing is lost in the sum
  uint8_t until_change;           // control periods until `errors` is full: the change of error is 0 until then
  uint8_t oldest;                 // in `errors`
  int16_t errors[most_ce_ticks];  // the last ce_ticks errors, in turn
};

// A joint's controller. Both parts are together because the assembly reaches both from one address.
struct Joint {
  Coefficients coefficients;
  State state;
};

struct Output {
  int16_t u_fuzzy;  // q15; 1.0 is 32767 here, 32768 inside
  int16_t volts_mv;
  bool saturated;  // the law wanted more than limit_mv
  bool no_rule;    // no rule fired, u_fuzzy is 0
};

// Derives the coefficients. Leaves `out` untouched unless it returns Refusal::none. Divides: not for the tick.
Refusal compile(const Settings& settings, uint8_t period_ms, Coefficients& out);

// Begins anew, but for an integral that goes on; due before the first step and whenever the coefficients have changed.
void reset(const Coefficients& c, State& state, int32_t integral = 0);

// a - b, saturated so that its size has 15 bits.
inline int16_t difference(int16_t a, int16_t b) {
  const int32_t exact = int32_t{a} - b;
  return static_cast<int16_t>(exact > 32767 ? 32767 : exact < -32767 ? -32767 : exact);
}

// One control period. error = difference(leader, follower), +-8 rad; limit_mv (0..32767) is the voltage available now.
// The integral takes the error in unless the output is beyond the limit on the error's own side.
#if defined(__AVR__) && !defined(FUZZY_PDI_PORTABLE)
extern "C" Output fuzzy_pdi_step_error(Joint* joint, int16_t error, uint16_t limit_mv);  // step_avr.S

inline Output step_error(Joint& joint, int16_t error_q12, uint16_t limit_mv) {
  return fuzzy_pdi_step_error(&joint, error_q12, limit_mv);
}
#else
Output step_error(const Coefficients& c, State& state, int16_t error_q12, uint16_t limit_mv);

inline Output step_error(Joint& joint, int16_t error_q12, uint16_t limit_mv) {
  return step_error(joint.coefficients, joint.state, error_q12, limit_mv);
}

inline Output step(const Coefficients& c, State& state, int16_t leader_q12, int16_t follower_q12, uint16_t limit_mv) {
  return step_error(c, state, difference(leader_q12, follower_q12), limit_mv);
}
#endif

}  // namespace fuzzy_pdi
