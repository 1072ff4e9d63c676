// Runs the arm under the ideal controller: see simulate.h.
#include "ideal/simulate.h"

#include <algorithm>

#include "arm/supply.h"
#include "closed_loop/experiment.h"
#include "share_out.h"

namespace greywhale::ideal {

namespace {

using loop::kSlice, loop::kSlices;

arm::State<double> at_rest(const double* home) {
  arm::State<double> s{};
  std::copy_n(home, kJoints, s.q);
  std::copy_n(home, kJoints, s.motor_q);
  return s;
}

void simulate_one(const Experiment& x, const Tuning* tuning, double* mse, double* angles) {
  static constexpr double kNoLoad[kJoints] = {};
  const loop::PlantRow& row = *reinterpret_cast<const loop::PlantRow*>(x.plant);
  Law law(row.plant, x.supply, tuning, kSlice);
  arm::State<double> s = at_rest(x.leader);
  const bool worn = arm::is_worn(row.plant), sags = row.supply.resistance > 0.0;
  bool arrived = false;
  for (std::size_t n = 0; n < x.slices; ++n) {
    const std::size_t known = n > x.late ? n - x.late : 0, before = known > 0 ? known - 1 : 0;
    double leader[kJoints], speed[kJoints], volts[kJoints];
    for (std::size_t i = 0; i < kJoints; ++i) {
      leader[i] = x.leader[known * kJoints + i];
      speed[i] = (leader[i] - x.leader[before * kJoints + i]) / kSlice;
      if (n % kSlices == 0) {
        const double error = x.leader[n * kJoints + i] - s.q[i];
        mse[i] += error * error * static_cast<double>(kSlices) / static_cast<double>(x.slices);
        if (angles) *angles++ = s.q[i];
      }
    }
    law.volts(s, leader, speed, volts);
    if (x.chase.joint < kJoints) {
      const int direction = x.chase.direction[n];
      arrived = direction != 0 && (arrived || direction * (s.q[x.chase.joint] - x.chase.until[n]) >= 0.0);
      if (direction != 0 && !arrived) volts[x.chase.joint] = direction * x.supply;
    }
    // The law asks for what is to arrive, so its driver gets more: only the most that can arrive is less.
    for (std::size_t i = 0; i < kJoints; ++i) {
      const arm::Driver<double>& driver = row.plant.joints[i].driver;
      volts[i] = std::clamp(volts[i], driver.lost_down - x.supply, x.supply - driver.lost_up);
    }
    if (sags) arm::sag(row.plant.joints, row.supply, s, volts);
    arm::advance(row.plant, s, volts, kNoLoad, kSlice, worn);
  }
}

}  // namespace

void simulate(const Experiment& x, const Tuning* tunings, std::size_t count, int threads, double* mse, double* angles) {
  const std::size_t size = x.slices / kSlices * kJoints;
  share_out(count, threads, [&](std::size_t n) {
    simulate_one(x, tunings + n * kJoints, mse + n * kJoints, angles ? angles + n * size : nullptr);
  });
}

}  // namespace greywhale::ideal
