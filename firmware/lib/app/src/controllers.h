// The four fuzzy PD+I controllers and what they need of the parameter table.
#pragma once
#include <fuzzy_pdi.h>
#include <hal.h>
#include <multiply.h>
#include <params/table.h>
#include <stddef.h>
#include <stdint.h>

namespace app {

// What the app wants of a fuzzy_pdi::Output.
struct Outcome {
  int16_t volts_mv;
  bool no_rule;
};

#if defined(__AVR__) && !defined(FUZZY_PDI_PORTABLE)

// fuzzy_pdi::step() called by hand. Its bare entry saves no registers: they are saved once a tick instead of once a joint. And
// avr-gcc would put the returned struct, which comes in registers, on the stack first. Together that spares 90 cycles a joint.
inline __attribute__((always_inline)) Outcome step_in_registers(
  const fuzzy_pdi::Coefficients& c, fuzzy_pdi::State& s, int16_t leader, int16_t follower, uint16_t limit) {
  static_assert(sizeof(fuzzy_pdi::Output) == 6, "returned in r18..r23");
  static_assert(offsetof(fuzzy_pdi::Output, volts_mv) == 2 && offsetof(fuzzy_pdi::Output, no_rule) == 5, "see below");
  register const fuzzy_pdi::Coefficients* r24 __asm__("r24") = &c;
  register uint16_t r22 __asm__("r22") = reinterpret_cast<uint16_t>(&s);
  register int16_t r20 __asm__("r20") = leader;
  register int16_t r18 __asm__("r18") = follower;
  register uint16_t r16 __asm__("r16") = limit;
  __asm__ volatile("%~call fuzzy_pdi_step_bare"
      : "+r"(r24), "+r"(r22), "+r"(r20), "+r"(r18), "+r"(r16)
      :
      : "r2", "r3", "r4", "r5", "r6", "r7", "r8", "r9", "r10", "r11", "r12", "r13", "r14", "r15", "r26", "r27", "r30", "r31",
        "memory");
  return {r20, static_cast<uint8_t>(r22 >> 8) != 0};
}

#else

inline Outcome step_in_registers(const fuzzy_pdi::Coefficients& c, fuzzy_pdi::State& s, int16_t leader, int16_t follower,
                                 uint16_t limit) {
  const fuzzy_pdi::Output out = fuzzy_pdi::step(c, s, leader, follower, limit);
  return {out.volts_mv, out.no_rule};
}

#endif

class Controllers {
 public:
  // Takes a joint's settings over, unless they cannot be run; only while the motors are off. Costs most of a tick.
  fuzzy_pdi::Refusal take(const params::Table& table, uint8_t joint);

  void reset();
  // The voltage that may be used now; ramp_q15 is the share of the supply, 32768 all of it.
  uint16_t limit_mv(uint16_t ramp_q15) const {
    return hal::upper_product(static_cast<uint16_t>(supply_mv_ * 2), ramp_q15);   // (supply * ramp) >> 15
  }
  // One control period of a joint: the voltage for its motor.
  int16_t step(uint8_t joint, int16_t reference, int16_t follower, uint16_t limit_mv) {
    const Outcome out = step_in_registers(coefficients_[joint], states_[joint], reference, follower, limit_mv);
    if (out.no_rule) count_no_rule();
    volts_mv_[joint] = out.volts_mv;
    return out.volts_mv;
  }

  int16_t volts_mv(uint8_t joint) const { return volts_mv_[joint]; }
  uint16_t no_rule() const { return no_rule_; }   // stops at 65535

 private:
  void count_no_rule();

  fuzzy_pdi::Coefficients coefficients_[hal::joint_count] = {};
  fuzzy_pdi::State states_[hal::joint_count] = {};
  int16_t volts_mv_[hal::joint_count] = {};
  uint16_t supply_mv_ = 0;
  uint16_t no_rule_ = 0;
};

}  // namespace app
