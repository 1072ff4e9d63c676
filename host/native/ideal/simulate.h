// The arm under the ideal controller of law.h, for many tunings of it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ideal/law.h"

namespace greywhale::ideal {

// One joint that runs at full voltage while the others are controlled: in each slice the direction (0: it is controlled
// too), and the angle at which it has gone far enough.
struct Chase {
  std::size_t joint;  // kJoints: none
  const std::int8_t* direction;
  const double* until;
};

struct Experiment {
  const double* leader;  // slices x 4: rad, when the slice begins
  std::size_t slices;    // whole ticks
  std::size_t late;      // slices after which the controller learns of the leader
  const double* plant;   // a row of plants
  double supply;         // V, at most the plant's
  Chase chase;
};

// Mean squared errors (count x 4, rad^2) and, unless null, the angles at the beginning of every tick (count x ticks x
// 4, rad), with four tunings for each of `count` controllers. `mse` comes as zeros.
void simulate(const Experiment& experiment, const Tuning* tunings, std::size_t count, int threads, double* mse,
              double* angles);

}  // namespace greywhale::ideal
