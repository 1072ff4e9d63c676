// The plant in as many lanes as a vector of doubles has; every lane has the bits of the plant in plain doubles.
// Included once by each instruction set's file, each with a vector type of its own.
#pragma once

#include <cmath>
#include <cstddef>

#include "windows.h"

namespace greywhale::windows {

typedef double Vector __attribute__((vector_size(GREYWHALE_LANES * sizeof(double))));
typedef decltype(Vector{} < Vector{}) Condition;

}  // namespace greywhale::windows

namespace greywhale::arm {

// Found by the plant's templates, so declared before them.
inline __attribute__((always_inline)) bool any(windows::Condition mask) {
  bool found = false;
  for (std::size_t n = 0; n < GREYWHALE_LANES; ++n) found = found || mask[n] != 0;
  return found;
}

inline __attribute__((always_inline)) void sine_cosine(windows::Vector angle, windows::Vector& sine, windows::Vector& cosine) {
  for (std::size_t n = 0; n < GREYWHALE_LANES; ++n) {
    sine[n] = std::sin(angle[n]);
    cosine[n] = std::cos(angle[n]);
  }
}

}  // namespace greywhale::arm

#include "arm/step.h"

namespace greywhale::windows {

using arm::kJoints;

static void simulate(const Windows& w, const Lane* lanes, std::size_t count) {
  constexpr std::size_t kColumns = sizeof(arm::Plant<double>) / sizeof(double);
  static_assert(sizeof(arm::Plant<Vector>) == kColumns * sizeof(Vector));
  const Vector no_load[kJoints] = {};
  // Lanes without a task repeat the last one's.
  const auto of = [&](std::size_t n) -> const Lane& { return lanes[n < count ? n : count - 1]; };
  arm::Plant<Vector> plant;
  arm::State<Vector> s;
  Vector offset[kJoints];
  std::size_t first[GREYWHALE_LANES];
  for (std::size_t n = 0; n < GREYWHALE_LANES; ++n) {
    const Lane& lane = of(n);
    for (std::size_t c = 0; c < kColumns; ++c) reinterpret_cast<Vector*>(&plant)[c][n] = lane.plant[c];
    first[n] = static_cast<std::size_t>(w.first[lane.window]);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t at = lane.window * kJoints + i;
      offset[i][n] = lane.offset[i];
      s.q[i][n] = w.angles[at] + lane.offset[i];
      s.v[i][n] = w.velocities[at] + lane.kick[i];
      s.motor_q[i][n] = s.q[i][n] + w.sides[at] * plant.joints[i].gear.half_gap[n];
      s.motor_v[i][n] = s.v[i][n];
    }
  }
  std::size_t kept = 0;
  for (std::size_t row = 0; row < w.rows; ++row) {
    if (row % w.every == 0) {
      for (std::size_t n = 0; n < count; ++n) {
        for (std::size_t i = 0; i < kJoints; ++i) lanes[n].out[kept + i] = s.q[i][n] - offset[i][n];
      }
      kept += kJoints;
    }
    const double dt = w.spacing[first[0] + row] / static_cast<double>(w.substeps);
    for (std::size_t step = 0; step < w.substeps; ++step) {
      Vector volts[kJoints];
      for (std::size_t n = 0; n < GREYWHALE_LANES; ++n) {
        const double* now = w.volts + ((first[n] + row) * w.substeps + step) * kJoints;
        for (std::size_t i = 0; i < kJoints; ++i) volts[i][n] = now[i];
      }
      arm::advance(plant, s, volts, no_load, dt);
    }
  }
}

}  // namespace greywhale::windows
