// See signals.h.
#include "signals.h"

#include <fuzzy_pdi.h>

namespace app {
namespace {

int16_t clamp(int16_t value, int16_t least, int16_t most) {
  return value < least ? least : value > most ? most : value;
}

int16_t follow(Pot& pot, uint16_t sum, const Signals& signals) {
  pot.filtered = hal::blend(pot.filtered, signals.keep, sum, signals.gain);
  return angle(pot);
}

void note_rail(uint8_t pot, uint16_t sum, const Signals& signals, supervisor::Observation& seen) {
  if (static_cast<uint16_t>(sum - signals.lowest) <= signals.span) return;
  uint8_t& rail = sum < signals.lowest ? seen.rail_low : seen.rail_high;
  rail = static_cast<uint8_t>(rail | (1u << pot));
}

}  // namespace

void follow_pots_portable(const uint16_t* sums, Signals* signals, supervisor::Observation* seen) {
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    const uint8_t other = static_cast<uint8_t>(i + hal::joint_count);
    note_rail(i, sums[i], *signals, *seen);
    note_rail(other, sums[other], *signals, *seen);
    JointSignals& joint = signals->joint[i];
    const int16_t wanted = clamp(follow(joint.leader, sums[i], *signals), joint.limit_min, joint.limit_max);
    const int16_t is = follow(joint.follower, sums[other], *signals);
    joint.follower_angle = is;
    joint.error = fuzzy_pdi::difference(wanted, is);
    seen->distance[i] = static_cast<uint16_t>(wanted > is ? wanted - is : is - wanted);
  }
}

}  // namespace app
