// How rattle, chatter and ripple of simulated candidates are measured; greywhale/measure/swings.py says what they are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "closed_loop/band_power.h"
#include "score/run.h"

namespace greywhale::score {

// As Python hands it over, in this order.
struct SwingMeasure {
  double low[6], high[6];  // sections of the filter for rattle: b0, b1, b2, a0 = 1, a1, a2
  double filter_ticks;     // between two angles that are filtered
  double block;            // of them
  double react_blocks;     // in which a joint still answers its leader
  double duty_share;       // of full duty, is a swing of chatter
  double ripple_ticks;     // of the mean that is no ripple
};

// The power of followers at 6 to 40 Hz beyond the highest that their leader had there in the last blocks.
class Rattle {
 public:
  // `leader` has a row a tick. What is before `first_block` does not count.
  Rattle(const double* leader, std::size_t ticks, std::size_t first_block, const SwingMeasure& measure);

  // Of angles with a row a tick, rad rms; NaN where no block counts.
  std::array<double, kJoints> of(const float* angles) const;

 private:
  SwingMeasure measure_;
  std::size_t first_block_;
  std::vector<double> allowed_;  // blocks x 4
};

// Swings of duties, rows x 4, by more than a share of each joint's full duty.
std::array<std::int32_t, kJoints> duty_swings(const std::int16_t* duties, std::size_t rows,
                                              const std::array<int, kJoints>& pwm_top, double share);

}  // namespace greywhale::score
