// See controllers.h.
#include "controllers.h"

namespace app {
namespace {

fuzzy_pdi::Settings settings_of(const params::Table& table, uint8_t joint) {
  const params::JointParameters& p = table.joint[joint];
  return {p.ne_c, p.ze_a, p.ze_c, p.pe_b, p.nce_c, p.zce_a, p.zce_c, p.pce_b, p.kp, p.kd, p.ki, p.ku_mv};
}

}  // namespace

fuzzy_pdi::Refusal Controllers::take(const params::Table& table, uint8_t joint) {
  const auto refusal = fuzzy_pdi::compile(settings_of(table, joint), table.period_ms, coefficients_[joint]);
  if (refusal != fuzzy_pdi::Refusal::none) return refusal;
  limit_min_[joint] = table.joint[joint].limit_min;
  limit_max_[joint] = table.joint[joint].limit_max;
  supply_mv_ = table.supply_mv;
  return refusal;
}

void Controllers::reset() {
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    fuzzy_pdi::reset(states_[i]);
    volts_mv_[i] = 0;
  }
}

int16_t Controllers::reference(uint8_t joint, int16_t leader) const {
  if (leader < limit_min_[joint]) return limit_min_[joint];
  if (leader > limit_max_[joint]) return limit_max_[joint];
  return leader;
}

// (supply * ramp) >> 15, written as one shift by 16
uint16_t Controllers::limit_mv(uint16_t ramp_q15) const {
  return static_cast<uint16_t>((static_cast<uint32_t>(supply_mv_) * ramp_q15 * 2) >> 16);
}

int16_t Controllers::step(uint8_t joint, int16_t reference, int16_t follower, uint16_t limit_mv) {
  const fuzzy_pdi::Output out =
    fuzzy_pdi::step(coefficients_[joint], states_[joint], reference, follower, limit_mv);
  if (out.no_rule && no_rule_ != UINT16_MAX) ++no_rule_;
  volts_mv_[joint] = out.volts_mv;
  return out.volts_mv;
}

}  // namespace app
