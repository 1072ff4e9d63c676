// What candidates did in an experiment, as it is scored.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "closed_loop/experiment.h"

namespace greywhale::score {

using loop::kJoints;

// A trace has a row a tick.
struct Run {
  std::size_t count, ticks;
  const double *mse, *itae, *itau;  // count x 4
  const bool* diverged;             // count
  const float* angles;              // count x ticks x 4, rad
  const std::int16_t* duties;       // count x ticks x 4
  std::array<int, kJoints> pwm_top;
};

// As numpy has it: what is no number stays so.
inline double larger(double a, double b) { return a >= b || a != a ? a : b; }

}  // namespace greywhale::score
