// See motion.h.
#include "motion.h"

namespace supervisor {
namespace {

constexpr uint16_t pushes_mv = 2000;  // from here on a voltage counts as one that the joint runs against
constexpr uint16_t turns = 8;         // q12 rad a look: noise moves a reading less
constexpr uint8_t noise = 2;          // 1/1024 rad a look, of a speed
constexpr uint8_t relief = 3;         // looks that one below the limit takes off
constexpr int8_t place_reached = 3;   // 1/256 rad: noise is less

uint16_t size_of(int16_t value) {
  return value < 0 ? static_cast<uint16_t>(-static_cast<uint16_t>(value)) : static_cast<uint16_t>(value);
}

}  // namespace

MotionFault Motion::look(uint8_t joint, int16_t follower, int16_t volts_mv, uint16_t supply_mv,
                         const MotionLimits& limits) {
  Joint& seen = joints_[joint];
  const auto mask = static_cast<uint8_t>(1u << joint);
  const auto moved = static_cast<int16_t>(static_cast<uint16_t>(follower) - static_cast<uint16_t>(seen.last));
  seen.last = follower;
  if (!(known_ & mask)) {
    known_ = static_cast<uint8_t>(known_ | mask);
    seen.back = seen.peak = seen.stayed = 0;
    return MotionFault::none;
  }
  // 131 / 8 q12 rad a look are 1 rad/s.
  if (limits.speed != 0 && size_of(moved) > limits.speed * 131u / 8) return MotionFault::speed;
  if (runs_away(seen, moved, volts_mv, limits.runaway)) return MotionFault::runaway;
  if (is_stalled(seen, follower, size_of(volts_mv), supply_mv, limits)) return MotionFault::stalled;
  return MotionFault::none;
}

bool Motion::runs_away(Joint& joint, int16_t moved, int16_t volts_mv, uint8_t limit) {
  const bool against = (volts_mv < 0) == (moved > 0);
  const uint16_t way = size_of(moved);
  if (way > turns && (!against || (moved > 0) != (joint.back > 0))) joint.back = joint.peak = 0;
  if (!against || size_of(volts_mv) < pushes_mv) return false;
  const auto speed = static_cast<uint16_t>(way / 4u);
  if (speed > joint.peak) joint.peak = speed > 255 ? uint8_t{255} : static_cast<uint8_t>(speed);
  if (speed + joint.peak / 16u + noise < joint.peak) return false;
  joint.back = static_cast<int16_t>(joint.back + moved);
  return limit != 0 && size_of(joint.back) > limit * 32u;
}

bool Motion::is_stalled(Joint& joint, int16_t follower, uint16_t size_mv, uint16_t supply_mv,
                        const MotionLimits& limits) {
  const auto at = static_cast<uint8_t>(static_cast<uint16_t>(follower) >> 4);
  const auto away = static_cast<int8_t>(at - joint.place);
  const bool left = away >= place_reached || away <= -place_reached;
  if (left || joint.stayed == 0) joint.place = at;
  if (left || limits.stall == 0) {
    joint.stayed = 0;
  } else if (size_mv <= limits.stall * 100u) {
    joint.stayed = joint.stayed > relief ? static_cast<uint8_t>(joint.stayed - relief) : uint8_t{0};
  } else {
    const uint8_t more = size_mv > supply_mv / 2u ? 2 : 1;
    joint.stayed = joint.stayed > 255 - more ? uint8_t{255} : static_cast<uint8_t>(joint.stayed + more);
  }
  return joint.stayed >= limits.time && joint.stayed != 0;
}

}  // namespace supervisor
