// The four fuzzy PD+I controllers and what they need of the parameter table.
#pragma once
#include <fuzzy_pdi.h>
#include <hal.h>
#include <params/table.h>
#include <stdint.h>

namespace app {

class Controllers {
  public:
    // Whether a joint's settings can be run; costs a few thousand cycles.
    static fuzzy_pdi::Refusal check(const params::Table& table, uint8_t joint);
    // Takes a joint's settings over; only while the motors are off and after check().
    void take(const params::Table& table, uint8_t joint);

    void reset();
    // The leader within the joint's limits: what the follower is asked for.
    int16_t reference(uint8_t joint, int16_t leader) const;
    // One control period of all joints; ramp_q15 is the share of the supply that may be used, 32768 all of it.
    void step(const int16_t* references, const int16_t* followers, uint16_t ramp_q15);

    const int16_t* volts_mv() const { return volts_mv_; }
    uint16_t no_rule() const { return no_rule_; }   // stops at 65535

  private:
    fuzzy_pdi::Coefficients coefficients_[hal::joint_count] = {};
    fuzzy_pdi::State states_[hal::joint_count] = {};
    int16_t volts_mv_[hal::joint_count] = {};
    int16_t limit_min_[hal::joint_count] = {}, limit_max_[hal::joint_count] = {};
    uint16_t supply_mv_ = 0;
    uint16_t no_rule_ = 0;
};

}  // namespace app
