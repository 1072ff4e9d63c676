// Short windows of a log, each started from its own state and driven by the logged voltages, for many candidate arms at a time.
// greywhale.identify prepares the windows and compares the outcome with the log; use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "arm/step.h"
#include "bindings.h"
#include "closed_loop/experiment.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace arm = greywhale::arm;
namespace loop = greywhale::loop;

namespace {

using arm::kJoints;

template <class T, class... Shape>
using In = nb::ndarray<const T, Shape..., nb::c_contig, nb::device::cpu>;
using Rows = In<double, nb::shape<-1, kJoints>>;
using Plants = In<double, nb::shape<-1, loop::kPlantColumns>>;

// Where a window begins and how the arm stands there; the arrays are Python's and outlive the call.
struct Windows {
  In<std::int64_t, nb::shape<-1>> first;  // row
  Rows angles, velocities;                // of the links, rad and rad/s
  Rows sides;                             // -1..1, where in its gap each motor side stands
  std::size_t rows;                       // of every window
};

// The log on the integration's grid: `substeps` voltages for every row, and the time from a row to the next.
struct Drive {
  Rows volts;
  In<double, nb::shape<-1>> spacing;
  std::size_t substeps;
};

// What a candidate reads of its own angles: the potentiometers' zero, and how much faster the links started than estimated.
struct Start {
  Rows offsets, kicks;
};

void simulate(const Windows& w, const Drive& drive, const arm::Plant<double>& plant, const double* offset, const double* kick,
              std::size_t window, std::size_t every, double* out) {
  static constexpr double kNoLoad[kJoints] = {};
  arm::State<double> s;
  for (std::size_t i = 0; i < kJoints; ++i) {
    s.q[i] = w.angles(window, i) + offset[i];
    s.v[i] = w.velocities(window, i) + kick[i];
    s.motor_q[i] = s.q[i] + w.sides(window, i) * plant.joints[i].gear.half_gap;
    s.motor_v[i] = s.v[i];
  }
  const auto first = static_cast<std::size_t>(w.first(window));
  for (std::size_t row = 0; row < w.rows; ++row) {
    if (row % every == 0) {
      for (std::size_t i = 0; i < kJoints; ++i) *out++ = s.q[i] - offset[i];
    }
    const double dt = drive.spacing(first + row) / static_cast<double>(drive.substeps);
    for (std::size_t n = 0; n < drive.substeps; ++n) {
      double volts[kJoints];
      std::copy_n(&drive.volts((first + row) * drive.substeps + n, 0), kJoints, volts);
      arm::advance(plant, s, volts, kNoLoad, dt);
    }
  }
}

arm::Plant<double> plant_of(const Plants& plants, std::size_t n) {
  loop::PlantRow row;
  std::copy_n(&plants(n, 0), loop::kPlantColumns, reinterpret_cast<double*>(&row));
  return row.plant;
}

void check(const Windows& w, const Drive& drive, const Plants& plants, const Start& start, std::size_t every) {
  const std::size_t rows = drive.spacing.shape(0);
  if (every == 0 || drive.substeps == 0) throw std::invalid_argument("every and substeps must be 1 or more.");
  if (drive.volts.shape(0) != rows * drive.substeps) throw std::invalid_argument("volts must hold `substeps` rows for every spacing.");
  const std::size_t count = w.first.shape(0);
  if (w.angles.shape(0) != count || w.velocities.shape(0) != count || w.sides.shape(0) != count) {
    throw std::invalid_argument("first, angles, velocities and sides differ in length.");
  }
  if (start.offsets.shape(0) != plants.shape(0) || start.kicks.shape(0) != plants.shape(0)) {
    throw std::invalid_argument("offsets and kicks need a row for every plant.");
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (w.first(n) < 0 || static_cast<std::size_t>(w.first(n)) + w.rows > rows) {
      throw std::invalid_argument("a window reaches beyond the log.");
    }
  }
}

// Every (candidate, window) pair once, from as many threads as there are cores or as asked; the order does not matter.
nb::object run(const Windows& w, const Drive& drive, const Plants& plants, const Start& start, std::size_t every, int threads) {
  check(w, drive, plants, start, every);
  const std::size_t candidates = plants.shape(0), windows = w.first.shape(0), kept = (w.rows + every - 1) / every;
  const std::size_t size = kept * kJoints;
  auto values = std::make_unique<double[]>(candidates * windows * size);
  {
    const nb::gil_scoped_release free;
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t task = next++; task < candidates * windows; task = next++) {
        const std::size_t n = task / windows;
        simulate(w, drive, plant_of(plants, n), &start.offsets(n, 0), &start.kicks(n, 0), task % windows, every, &values[task * size]);
      }
    };
    const std::size_t cores = threads > 0 ? static_cast<std::size_t>(threads) : std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::thread> helpers;
    for (std::size_t n = 1; n < cores; ++n) helpers.emplace_back(work);
    work();
    for (std::thread& helper : helpers) helper.join();
  }
  double* raw = values.release();
  nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double, nb::c_contig>(raw, {candidates, windows, kept, kJoints}, owner));
}

}  // namespace

void bind_identify(nb::module_& m) {
  m.def(
      "simulate_windows",
      [](const Plants& plants, const Rows& offsets, const Rows& kicks, const In<std::int64_t, nb::shape<-1>>& first, const Rows& angles,
         const Rows& velocities, const Rows& sides, std::size_t rows, const Rows& volts, const In<double, nb::shape<-1>>& spacing,
         std::size_t substeps, std::size_t every, int threads) {
        return run({first, angles, velocities, sides, rows}, {volts, spacing, substeps}, plants, {offsets, kicks}, every, threads);
      },
      nb::kw_only(), "plants"_a.noconvert(), "offsets"_a.noconvert(), "kicks"_a.noconvert(), "first"_a.noconvert(), "angles"_a.noconvert(),
      "velocities"_a.noconvert(), "sides"_a.noconvert(), "rows"_a, "volts"_a.noconvert(), "spacing"_a.noconvert(), "substeps"_a, "every"_a,
      "threads"_a = 0, "Angles (candidates, windows, rows kept, 4) of candidate arms under logged voltages. The GIL is released.");
}
