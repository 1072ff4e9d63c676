#include "score/swing_measure.h"

#include <cmath>
#include <limits>

#include "closed_loop/swings.h"

namespace greywhale::score {

namespace {

loop::Section<kJoints> section(const double (&n)[6]) { return {n[0], n[1], n[2], n[4], n[5]}; }

template <class T>
std::vector<double> power_of(const T* angles, std::size_t blocks, const SwingMeasure& measure) {
  std::vector<double> power(blocks * kJoints);
  loop::band_power<kJoints>(angles, static_cast<std::size_t>(measure.filter_ticks), blocks,
                            static_cast<std::size_t>(measure.block), section(measure.low), section(measure.high),
                            power.data());
  return power;
}

// The place of a block before the first: there the blocks are as in a mirror.
std::size_t mirrored(std::size_t before, std::size_t blocks) {
  const std::size_t at = (before - 1) % (2 * blocks);
  return at < blocks ? at : 2 * blocks - 1 - at;
}

}  // namespace

Rattle::Rattle(const double* leader, std::size_t ticks, std::size_t first_block, const SwingMeasure& measure)
    : measure_(measure), first_block_(first_block) {
  const auto stride = static_cast<std::size_t>(measure.filter_ticks);
  const auto back = static_cast<std::size_t>(measure.react_blocks);
  const std::size_t blocks = (ticks + stride - 1) / stride / static_cast<std::size_t>(measure.block);
  const std::vector<double> led = power_of(leader, blocks, measure);
  allowed_ = led;
  for (std::size_t block = 0; block < blocks; ++block) {
    for (std::size_t n = 1; n <= back; ++n) {
      const std::size_t at = n <= block ? block - n : mirrored(n - block, blocks);
      for (std::size_t i = 0; i < kJoints; ++i)
        allowed_[block * kJoints + i] = larger(allowed_[block * kJoints + i], led[at * kJoints + i]);
    }
  }
}

std::array<double, kJoints> Rattle::of(const float* angles) const {
  const std::size_t blocks = allowed_.size() / kJoints;
  std::array<double, kJoints> rms;
  rms.fill(std::numeric_limits<double>::quiet_NaN());
  if (blocks <= first_block_) return rms;
  const std::vector<double> power = power_of(angles, blocks, measure_);
  for (std::size_t i = 0; i < kJoints; ++i) {
    double excess = 0.0;
    for (std::size_t at = first_block_ * kJoints + i; at < power.size(); at += kJoints)
      excess += larger(power[at] - allowed_[at], 0.0);
    rms[i] = std::sqrt(excess / static_cast<double>(blocks - first_block_));
  }
  return rms;
}

std::array<std::int32_t, kJoints> duty_swings(const std::int16_t* duties, std::size_t rows,
                                              const std::array<int, kJoints>& pwm_top, double share) {
  std::array<std::int32_t, kJoints> turns{};
  loop::Swings swings[kJoints];
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (i == 0 || pwm_top[i] != pwm_top[i - 1]) loop::swings_of<kJoints>(duties, rows, share * pwm_top[i], swings);
    turns[i] = swings[i].reversals;
  }
  return turns;
}

}  // namespace greywhale::score
