// The plant in lanes; every lane has the bits of the plant in plain doubles. core.cmake compiles it once for each
// instruction set.
#include <cstddef>

#include "arm/step.h"
#include "lanes.h"
#include "windows.h"

namespace greywhale::windows::GREYWHALE_INSTRUCTIONS {

using arm::kJoints;

namespace {

void simulate(const Windows& w, const Task* tasks, std::size_t count) {
  constexpr std::size_t kColumns = sizeof(arm::Plant<double>) / sizeof(double);
  static_assert(sizeof(arm::Plant<Lanes>) == kColumns * sizeof(Lanes));
  const Lanes no_load[kJoints] = {};
  // Lanes without a task repeat the last one's.
  const auto of = [&](std::size_t n) -> const Task& { return tasks[n < count ? n : count - 1]; };
  arm::Plant<Lanes> plant;
  arm::State<Lanes> s;
  Lanes offset[kJoints];
  std::size_t first[kLanes] = {};
  for (std::size_t n = 0; n < kLanes; ++n) {
    const Task& task = of(n);
    for (std::size_t c = 0; c < kColumns; ++c) reinterpret_cast<Lanes*>(&plant)[c].set(n, task.plant[c]);
    first[n] = static_cast<std::size_t>(w.first[task.window]);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t at = task.window * kJoints + i;
      offset[i].set(n, task.offset[i]);
      s.q[i].set(n, w.angles[at] + task.offset[i]);
      s.v[i].set(n, w.velocities[at] + task.kick[i]);
      s.motor_q[i].set(n, s.q[i][n] + w.sides[at] * plant.joints[i].gear.half_gap[n]);
      s.motor_v[i].set(n, s.v[i][n]);
    }
  }
  std::size_t kept = 0;
  for (std::size_t row = 0; row < w.rows; ++row) {
    if (row % w.every == 0) {
      for (std::size_t n = 0; n < count; ++n) {
        for (std::size_t i = 0; i < kJoints; ++i) tasks[n].out[kept + i] = s.q[i][n] - offset[i][n];
      }
      kept += kJoints;
    }
    const double dt = w.spacing[first[0] + row] / static_cast<double>(w.substeps);
    for (std::size_t step = 0; step < w.substeps; ++step) {
      Lanes volts[kJoints];
      for (std::size_t n = 0; n < kLanes; ++n) {
        const double* now = w.volts + ((first[n] + row) * w.substeps + step) * kJoints;
        for (std::size_t i = 0; i < kJoints; ++i) volts[i].set(n, now[i]);
      }
      arm::advance(plant, s, volts, no_load, dt);
    }
  }
}

}  // namespace

const Kernel kKernel = {simulate, kLanes};

}  // namespace greywhale::windows::GREYWHALE_INSTRUCTIONS
