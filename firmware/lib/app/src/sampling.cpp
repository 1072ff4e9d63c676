// See sampling.h.
#include "sampling.h"

namespace app {
namespace {

constexpr uint16_t full_count = 1023;

// angle = ((count14 - zero) * scale + 4096) >> 13 with filtered = 4 count14, multiplied out. The ranges of zero and scale keep
// every term within 31 bits and the angle within 16.
void calibrate(Pot& pot, const params::PotParameters& parameters) {
  pot.scale = parameters.scale;
  pot.offset = hal::make_offset(0x4000 - static_cast<int32_t>(parameters.zero) * 4 * parameters.scale);
}

}  // namespace

void Sampling::start_filter() {
  signals_.keep = static_cast<uint8_t>(256 - (256 >> shift_));
  signals_.gain = static_cast<uint8_t>(16 >> shift_);
}

void Sampling::configure(const params::Table& table) {
  shift_ = table.filter_shift;
  if (primed_) start_filter();
  const uint8_t rail = table.rail_counts;
  const uint16_t lowest = rail ? static_cast<uint16_t>(rail * hal::conversions_per_pot + 1) : 0;
  const uint16_t highest = static_cast<uint16_t>((full_count - rail) * hal::conversions_per_pot - 1);
  signals_.lowest = lowest;
  signals_.span = rail ? static_cast<uint16_t>(highest - lowest) : 0xffff;
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    JointSignals& joint = signals_.joint[i];
    calibrate(joint.leader, table.leader[i]);
    calibrate(joint.follower, table.follower[i]);
    joint.limit_min = table.joint[i].limit_min;
    joint.limit_max = table.joint[i].limit_max;
  }
}

void Sampling::tick(const uint16_t* sums, supervisor::Observation& seen) {
  seen.rail_low = seen.rail_high = 0;
  follow_pots(sums, &signals_, &seen);
  if (primed_) return;
  primed_ = true;
  start_filter();
}

int16_t Sampling::within_limits(uint8_t joint, int16_t angle) const {
  const JointSignals& signals = signals_.joint[joint];
  return angle < signals.limit_min ? signals.limit_min : angle > signals.limit_max ? signals.limit_max : angle;
}

uint16_t Sampling::distance(uint8_t joint) const {
  const int16_t wanted = within_limits(joint, leader(joint)), is = follower(joint);
  return static_cast<uint16_t>(wanted > is ? wanted - is : is - wanted);
}

void Sampling::lead(uint8_t joint, int16_t angle) {
  Pot& pot = signals_.joint[joint].leader;
  signals_.joint[joint].error = static_cast<int16_t>(angle - follower(joint));
  pot.scale = 0;
  pot.offset = hal::make_offset(static_cast<int32_t>(angle) * 0x8000 + 0x4000);
}

void Sampling::move_lead(uint8_t joint, int32_t by) {
  hal::Offset& offset = signals_.joint[joint].leader.offset;
  offset = hal::make_offset(hal::whole(offset) + by);
}

}  // namespace app
