// See sampling.h.
#include "sampling.h"

#include <multiply.h>

namespace app {
namespace {

constexpr uint16_t full_count = 1023;
constexpr uint8_t no_filter = 0xff;

// round(distance / 2^(halvings + 1))
inline uint16_t part_of(uint16_t distance, uint8_t halvings) {
  return static_cast<uint16_t>(((distance >> halvings) + 1u) >> 1);
}

// First-order low-pass, rounded so that it neither overshoots nor stops more than half a step short.
inline uint16_t low_pass(uint16_t old, uint16_t sample, uint8_t halvings) {
  if (halvings == no_filter) return sample;
  if (sample >= old) return static_cast<uint16_t>(old + part_of(static_cast<uint16_t>(sample - old), halvings));
  return static_cast<uint16_t>(old - part_of(static_cast<uint16_t>(old - sample), halvings));
}

// ((count14 - zero) * scale + 4096) >> 13, with one shift by 16 in place of 13 shifts by one. The ranges of zero and
// scale keep the product x 8 within 32 bits and the angle within 16.
inline int16_t to_angle(uint16_t filtered, uint16_t zero, int16_t scale) {
  const uint16_t count14 = static_cast<uint16_t>((filtered + 2u) >> 2);
  const int16_t offset = static_cast<int16_t>(count14 - zero);
  const int32_t twice = hal::multiply(static_cast<int16_t>(offset * 2), scale);
  return static_cast<int16_t>((twice * 4 + 0x8000) >> 16);
}

}  // namespace

void Sampling::configure(const params::Table& table) {
  halvings_ = static_cast<uint8_t>(table.filter_shift - 1);   // no_filter for a shift of 0
  const uint8_t rail = table.rail_counts;
  lowest_ = rail ? static_cast<uint16_t>(rail * hal::conversions_per_pot + 1) : 0;
  const uint16_t highest = static_cast<uint16_t>((full_count - rail) * hal::conversions_per_pot - 1);
  span_ = rail ? static_cast<uint16_t>(highest - lowest_) : 0xffff;
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    pots_[i].zero = table.leader[i].zero;
    pots_[i].scale = table.leader[i].scale;
    pots_[i + hal::joint_count].zero = table.follower[i].zero;
    pots_[i + hal::joint_count].scale = table.follower[i].scale;
  }
}

inline __attribute__((always_inline)) void Sampling::follow(Pot& pot, uint16_t sum, uint8_t halvings) {
  const uint16_t filtered = low_pass(pot.filtered, static_cast<uint16_t>(sum << 4), halvings);
  pot.filtered = filtered;
  pot.angle = to_angle(filtered, pot.zero, pot.scale);
}

__attribute__((noinline)) void Sampling::note_rail(uint8_t pot, bool low) {
  uint8_t& mask = low ? rail_low_ : rail_high_;
  mask = static_cast<uint8_t>(mask | (1u << pot));
}

// A function of its own: within a longer one avr-gcc runs out of registers here.
__attribute__((noinline)) void Sampling::tick(const uint16_t* sums) {
  rail_low_ = rail_high_ = 0;
  const uint8_t halvings = primed_ ? halvings_ : no_filter;
  const uint16_t lowest = lowest_, span = span_;
  Pot* pot = pots_;
  for (uint8_t i = 0; i < hal::pot_count; ++i) {
    const uint16_t sum = *sums++;
    if (static_cast<uint16_t>(sum - lowest) > span) note_rail(i, sum < lowest);
    follow(*pot++, sum, halvings);
  }
  primed_ = true;
}

}  // namespace app
