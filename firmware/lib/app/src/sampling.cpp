// See sampling.h.
#include "sampling.h"

namespace app {
namespace {

constexpr uint16_t full_count = 1023;

void calibrate(signal_chain::Pot& pot, const params::PotParameters& parameters) {
  pot.scale = parameters.scale;
  pot.offset = signal_chain::offset(parameters.zero, parameters.scale);
}

}  // namespace

void Sampling::configure(const params::Table& table) {
  shift_ = table.filter_shift & 0x7f;
  const uint8_t rail = table.rail_counts;
  const uint16_t lowest = rail ? static_cast<uint16_t>(rail * hal::conversions_per_pot + 1) : 0;
  const uint16_t highest = static_cast<uint16_t>((full_count - rail) * hal::conversions_per_pot - 1);
  signals_.lowest = lowest;
  signals_.span = rail ? static_cast<uint16_t>(highest - lowest) : static_cast<uint16_t>(hal::rail_mark - 1);
  signals_.rails = rail ? tell_rails : 0;  // the motors are off, so nothing is held
  uint8_t in_use = 0;
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    JointSignals& joint = signals_.joint[i];
    in_use = static_cast<uint8_t>(in_use >> 1);
    if (table.leader[i].scale != 0) in_use |= 1u << 3;
    if (table.follower[i].scale != 0) in_use |= 1u << 7;
    calibrate(joint.leader, table.leader[i]);
    calibrate(joint.follower, table.follower[i]);
    joint.limit_min = table.joint[i].limit_min;
    joint.limit_max = table.joint[i].limit_max;
    joint.follower_angle = signal_chain::angle(joint.follower);
    // A joint that is not in use has no error, so no voltage.
    if (joint.follower.scale == 0) joint.limit_min = joint.limit_max = 0;
  }
  pots_in_use_ = in_use;
  prepare();
}

void Sampling::tick(const uint16_t* sums, supervisor::Observation& seen) {
  follow_pots(sums, &signals_, &seen);
  primed_ = true;
}

void Sampling::prepare() {
  if (primed_) signals_.low_pass = signal_chain::low_pass(shift_);
  keep_filtered(signals_);
}

int16_t Sampling::within_limits(uint8_t joint, int16_t angle) const {
  const JointSignals& signals = signals_.joint[joint];
  return signal_chain::clamp(angle, signals.limit_min, signals.limit_max);
}

void Sampling::forget() {
  for (JointSignals& joint : signals_.joint) joint.error = not_seen;
}

uint16_t Sampling::distance(uint8_t joint) const {
  if (error(joint) == not_seen) return UINT16_MAX;
  return signal_chain::distance(within_limits(joint, leader(joint)), follower(joint));
}

void Sampling::lead(uint8_t joint, int16_t angle) {
  signal_chain::Pot& pot = signals_.joint[joint].leader;
  signals_.joint[joint].error = static_cast<int16_t>(angle - follower(joint));
  pot.scale = 0;
  pot.offset = static_cast<int32_t>(angle) * 0x8000 + 0x4000;
}

void Sampling::move_lead(uint8_t joint, int32_t by) { signals_.joint[joint].leader.offset += by; }

}  // namespace app
