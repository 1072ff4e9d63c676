// See sampling.h.
#include "sampling.h"

#define INLINE inline __attribute__((always_inline))

namespace app {
namespace {

constexpr uint16_t full_count = 1023;

INLINE int16_t clamp(int16_t value, int16_t least, int16_t most) {
  return value < least ? least : value > most ? most : value;
}

}  // namespace

// angle = ((count14 - zero) * scale + 4096) >> 13 with filtered = 4 count14, multiplied out. The ranges of zero and scale keep
// every term within 31 bits and the angle within 16.
void Sampling::calibrate(Pot& pot, const params::PotParameters& parameters) {
  pot.scale = parameters.scale;
  pot.offset = hal::make_offset(0x4000 - static_cast<int32_t>(parameters.zero) * 4 * parameters.scale);
}

void Sampling::configure(const params::Table& table) {
  chosen_.keep = static_cast<uint8_t>(256 - (256 >> table.filter_shift));
  chosen_.gain = static_cast<uint8_t>(16 >> table.filter_shift);
  if (primed_) filter_ = chosen_;
  const uint8_t rail = table.rail_counts;
  const uint16_t lowest = rail ? static_cast<uint16_t>(rail * hal::conversions_per_pot + 1) : 0;
  const uint16_t highest = static_cast<uint16_t>((full_count - rail) * hal::conversions_per_pot - 1);
  inside_.lowest = lowest;
  inside_.span = rail ? static_cast<uint16_t>(highest - lowest) : 0xffff;
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    calibrate(pots_[i], table.leader[i]);
    calibrate(pots_[i + hal::joint_count], table.follower[i]);
    joints_[i].limit_min = table.joint[i].limit_min;
    joints_[i].limit_max = table.joint[i].limit_max;
  }
}

template <uint8_t pot>
INLINE int16_t Sampling::angle(uint16_t sum, Filter filter, Inside inside, supervisor::Observation& seen) {
  if (static_cast<uint16_t>(sum - inside.lowest) > inside.span) {
    uint8_t& rail = sum < inside.lowest ? seen.rail_low : seen.rail_high;
    rail |= 1 << pot;
  }
  Pot& p = pots_[pot];
  const uint16_t filtered = hal::blend(p.filtered, filter.keep, sum, filter.gain);
  p.filtered = filtered;
  return p.angle = hal::line(filtered, p.scale, p.offset);
}

template <uint8_t joint>
INLINE void Sampling::lead(uint16_t sum, Filter filter, Inside inside, supervisor::Observation& seen) {
  Joint& j = joints_[joint];
  j.reference = clamp(angle<joint>(sum, filter, inside, seen), j.limit_min, j.limit_max);
}

template <uint8_t joint>
INLINE void Sampling::follow(uint16_t sum, Filter filter, Inside inside, supervisor::Observation& seen) {
  const int16_t is = angle<joint + hal::joint_count>(sum, filter, inside, seen);
  const int16_t wanted = joints_[joint].reference;
  seen.distance[joint] = static_cast<uint16_t>(wanted > is ? wanted - is : is - wanted);
}

// Pot by pot rather than in a loop: with all addresses known to the compiler, that saves a fifth of the cycles.
__attribute__((noinline)) void Sampling::tick(const uint16_t* sums, supervisor::Observation& seen) {
  static_assert(hal::joint_count == 4, "joints 0..3 below");
  const Filter filter = filter_;
  const Inside inside = inside_;
  seen.rail_low = seen.rail_high = 0;
  lead<0>(*sums++, filter, inside, seen);
  lead<1>(*sums++, filter, inside, seen);
  lead<2>(*sums++, filter, inside, seen);
  lead<3>(*sums++, filter, inside, seen);
  follow<0>(*sums++, filter, inside, seen);
  follow<1>(*sums++, filter, inside, seen);
  follow<2>(*sums++, filter, inside, seen);
  follow<3>(*sums, filter, inside, seen);
  filter_ = chosen_;
  primed_ = true;
}

}  // namespace app
