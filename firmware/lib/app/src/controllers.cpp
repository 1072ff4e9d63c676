// See controllers.h.
#ifdef __AVR__
#pragma GCC optimize("Os")  // step() is in the header; here flash is short
#endif

#include "controllers.h"

namespace app {
namespace {

fuzzy_pdi::Settings settings_of(const params::Table& table, uint8_t joint) {
  const params::JointParameters& p = table.joint[joint];
  const uint8_t ce_ticks = table.change[joint].ce_ticks;
  return {p.ne_c, p.ze_a, p.ze_c, p.pe_b, p.nce_c, p.zce_a, p.zce_c, p.pce_b, p.kp, p.kd, p.ki, p.ku_mv, ce_ticks};
}

}  // namespace

fuzzy_pdi::Refusal Controllers::take(const params::Table& table, uint8_t joint) {
  return fuzzy_pdi::compile(settings_of(table, joint), table.period_ms, joints_[joint].coefficients);
}

// A controller without an integral part would keep for ever what another left to it.
void Controllers::reset(bool keep_integrals) {
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    fuzzy_pdi::Joint& own = joints_[i];
    const bool keep = keep_integrals && own.coefficients.integral != 0;
    fuzzy_pdi::reset(own.coefficients, own.state, keep ? own.state.integral : 0);
    volts_[i] = 0;
  }
}

void Controllers::count_no_rule() {
  if (no_rule_ != UINT16_MAX) ++no_rule_;
}

}  // namespace app
