// The four fuzzy PD+I controllers and what they take from the parameter table.
#pragma once
#include <fuzzy_pdi.h>
#include <hal.h>
#include <params/table.h>
#include <signal_chain/duty.h>
#include <stdint.h>

#include "memory_check.h"

namespace app {

// The part of fuzzy_pdi::Output that the app uses.
struct MotorVoltage {
  uint16_t size_mv;
  uint8_t sign;       // bit 7: the voltage is negative
  uint16_t volts_mv;  // both: bit 15 is the sign
  bool no_rule;
};

#if defined(__AVR__) && !defined(FUZZY_PDI_PORTABLE)

// Calls the bare entry of fuzzy_pdi::step_error(). It saves no registers: hal::run_tick() lets the tick use all of
// them. It returns the size and the sign of the voltage apart, as the duty needs them.
inline __attribute__((always_inline)) MotorVoltage step_in_registers(fuzzy_pdi::Joint& joint, int16_t error,
                                                                     uint16_t limit) {
  register uint16_t r30 __asm__("r30") = reinterpret_cast<uint16_t>(&joint);
  register int16_t r24 __asm__("r24") = error;
  register uint16_t r4 __asm__("r4") = limit;
  register uint16_t r26 __asm__("r26");
  register uint8_t r17 __asm__("r17");
  register uint8_t r6 __asm__("r6");
  register uint16_t r2 __asm__("r2");
  __asm__ volatile(
      "%~call fuzzy_pdi_step_bare\n\t"
      "movw r2, r26\n\t"
      "bst r17, 7\n\t"
      "bld r3, 7"
      : "+r"(r30), "+r"(r24), "=r"(r26), "=r"(r17), "=r"(r6), "=r"(r2)
      : "r"(r4)
      : "r7", "r8", "r9", "r10", "r11", "r12", "r13", "r14", "r15", "r16", "r18", "r19", "r20", "r21", "r22", "r23",
        "memory");
  return {r26, r17, r2, r6 != 0};
}

#else

inline MotorVoltage step_in_registers(fuzzy_pdi::Joint& joint, int16_t error, uint16_t limit) {
  const fuzzy_pdi::Output out = fuzzy_pdi::step_error(joint, error, limit);
  const bool negative = out.volts_mv < 0;
  const auto size = static_cast<uint16_t>(negative ? -out.volts_mv : out.volts_mv);
  return {size, static_cast<uint8_t>(negative ? 0x80 : 0), static_cast<uint16_t>(negative ? size | 0x8000 : size),
          out.no_rule};
}

#endif

class Controllers {
 public:
  // Takes a joint's settings, unless they cannot be run. Only while the motors are off. It takes most of a tick.
  fuzzy_pdi::Refusal take(const params::Table& table, uint8_t joint);

  // Due when the motors go off and on. The integrals are in volts, so they fit another set too.
  void reset(bool keep_integrals);
  // The voltage that may be used from the next tick on: a share of the supply.
  void set_limit(uint16_t supply_mv, uint16_t share_q15) { limit_mv_ = signal_chain::limit_mv(supply_mv, share_q15); }
  uint16_t limit_mv() const { return limit_mv_; }
  // One control period of a joint: the voltage for its motor.
  MotorVoltage step(uint8_t joint, int16_t error, uint16_t limit_mv) {
    const MotorVoltage out = step_in_registers(joints_[joint], error, limit_mv);
    if (out.no_rule) count_no_rule();
    volts_[joint] = out.volts_mv;
    return out;
  }

  int16_t volts_mv(uint8_t joint) const {
    const auto size = static_cast<int16_t>(volts_[joint] & 0x7fff);
    return static_cast<int16_t>(volts_[joint] & 0x8000 ? -size : size);
  }
  Part coefficients(uint8_t joint) const {
    return {reinterpret_cast<const uint8_t*>(&joints_[joint].coefficients), sizeof(fuzzy_pdi::Coefficients)};
  }
  uint16_t no_rule() const { return no_rule_; }  // stops at 65535

 private:
  void count_no_rule();

  fuzzy_pdi::Joint joints_[hal::joint_count] = {};
  uint16_t volts_[hal::joint_count] = {};  // as in MotorVoltage::volts_mv
  uint16_t limit_mv_ = 0;
  uint16_t no_rule_ = 0;
};

}  // namespace app
