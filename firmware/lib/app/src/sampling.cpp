// See sampling.h.
#include "sampling.h"

namespace app {
namespace {

constexpr uint16_t full_count = 1023;

// First-order low-pass, rounded so that it neither overshoots nor stops more than half a step short.
inline uint16_t low_pass(uint16_t old, uint16_t sample, uint8_t shift, uint8_t half) {
    if (sample >= old) return static_cast<uint16_t>(old + (static_cast<uint16_t>(sample - old + half) >> shift));
    return static_cast<uint16_t>(old - (static_cast<uint16_t>(old - sample + half) >> shift));
}

// ((count14 - zero) * scale + 4096) >> 13, with one shift by 16 in place of 13 shifts by one. The ranges of zero and
// scale keep the product x 8 within 32 bits and the angle within 16.
inline int16_t to_angle(uint16_t filtered, uint16_t zero, int16_t scale) {
    const uint16_t count14 = static_cast<uint16_t>((filtered + 2u) >> 2);
    const int16_t offset = static_cast<int16_t>(count14 - zero);
    const int32_t product = static_cast<int32_t>(offset) * scale;
    return static_cast<int16_t>((product * 8 + 0x8000) >> 16);
}

}  // namespace

void Sampling::configure(const params::Table& table) {
    shift_ = table.filter_shift;
    half_ = static_cast<uint8_t>((1 << shift_) >> 1);
    const uint8_t rail = table.rail_counts;
    low_sum_ = rail ? static_cast<uint16_t>(rail * hal::conversions_per_pot + 1) : 0;
    high_sum_ = rail ? static_cast<uint16_t>((full_count - rail) * hal::conversions_per_pot - 1) : 0xffff;
    for (uint8_t i = 0; i < hal::joint_count; ++i) {
        pots_[i].zero = table.leader[i].zero;
        pots_[i].scale = table.leader[i].scale;
        pots_[i + hal::joint_count].zero = table.follower[i].zero;
        pots_[i + hal::joint_count].scale = table.follower[i].scale;
    }
}

void Sampling::tick(const uint16_t (&sums)[hal::pot_count]) {
    uint8_t low = 0, high = 0, bit = 1;
    for (uint8_t i = 0; i < hal::pot_count; ++i) {
        Pot& pot = pots_[i];
        const uint16_t sum = sums[i];
        if (sum < low_sum_) low = static_cast<uint8_t>(low | bit);
        if (sum > high_sum_) high = static_cast<uint8_t>(high | bit);
        bit = static_cast<uint8_t>(bit << 1);
        const uint16_t sample = static_cast<uint16_t>(sum << 4);
        pot.filtered = primed_ ? low_pass(pot.filtered, sample, shift_, half_) : sample;
        angle_[i] = to_angle(pot.filtered, pot.zero, pot.scale);
    }
    rail_low_ = low;
    rail_high_ = high;
    primed_ = true;
}

}  // namespace app
