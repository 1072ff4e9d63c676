// See scaling.h.
#ifdef __AVR__
#pragma GCC optimize("Os")  // between ticks there is time, and flash is short
#endif

#include "scaling.h"

#include <string.h>

namespace app {
namespace {

constexpr uint8_t ratio_one = 64;

bool is_plain(const params::Table& table) {
  uint8_t others = table.tremor_shift;
  for (const params::ScalingParameters& joint : table.scaling) others |= joint.ratio ^ ratio_one;
  return others == 0;
}

// The lower 16 bits of an angle in q10 rad.
int16_t q10(int32_t angle_q25) { return static_cast<int16_t>((static_cast<uint32_t>(angle_q25) << 1) >> 16); }

}  // namespace

void Scaling::begin(const params::Table& table) { on_ = clutch() != wire::Clutch::engaged || !is_plain(table); }

void Scaling::reset() {
  asked_ = disengaged_ = shifted_ = false;
  memset(shift_q10_, 0, sizeof shift_q10_);
}

// While the motors are off, a reference that is disengaged stays with the follower: so enable finds no distance, and
// engaging takes the pose that the arm has.
__attribute__((noinline)) bool Scaling::advance(bool motors_on, bool pedal, const params::Table& table,
                                                Sampling& sampling) {
  const bool disengaged = asked_ || pedal;
  if (!on_ && !disengaged) return false;
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    const int16_t pose = motors_on ? sampling.reference(i) : sampling.follower(i);
    if (disengaged) {
      if (!motors_on || !disengaged_) sampling.lead(i, pose);
      continue;
    }
    const int32_t scaled_q25 = (sampling.leader_q27(i, table) >> 8) * table.scaling[i].ratio;
    if (disengaged_) shift_q10_[i] = static_cast<int16_t>((pose >> 2) - q10(scaled_q25));
    const int32_t shift_q25 = (static_cast<int32_t>(shift_q10_[i]) * 0x10000) >> 1;
    sampling.approach(i, scaled_q25 + shift_q25, motors_on ? table.tremor_shift : uint8_t{0});
  }
  shifted_ |= disengaged_ && !disengaged;
  disengaged_ = disengaged;
  on_ = true;
  return true;
}

}  // namespace app
