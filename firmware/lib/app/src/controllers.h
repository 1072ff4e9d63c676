// The four fuzzy PD+I controllers and what they need of the parameter table.
#pragma once
#include <fuzzy_pdi.h>
#include <hal.h>
#include <multiply.h>
#include <params/table.h>
#include <stdint.h>

namespace app {

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
    const fuzzy_pdi::Output out =
      fuzzy_pdi::step(coefficients_[joint], states_[joint], reference, follower, limit_mv);
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
