// The arm under an ideal controller (ideal/law.h), for many tunings of it. greywhale.tune.floor searches among them; use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bindings.h"
#include "closed_loop/experiment.h"
#include "ideal/law.h"
#include "share_out.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace arm = greywhale::arm;
namespace ideal = greywhale::ideal;
namespace loop = greywhale::loop;

namespace {

using arm::kJoints;

template <class T, class... Shape>
using In = nb::ndarray<const T, Shape..., nb::c_contig, nb::device::cpu>;

constexpr std::size_t kOpen = 4;  // numbers of ideal::Tuning
static_assert(sizeof(ideal::Tuning) == kOpen * sizeof(double));

// One joint that runs at full voltage while the others are controlled: in each slice the direction (0: it is controlled too), and the
// angle at which it has gone far enough.
struct Chase {
  std::size_t joint;  // kJoints: none
  In<std::int8_t, nb::shape<-1>> direction;
  In<double, nb::shape<-1>> until;
};

struct Task {
  In<double, nb::shape<-1, kJoints>> leader;  // rad, in every slice
  std::size_t late;                           // slices after which the controller learns of it
  In<double, nb::shape<loop::kPlantColumns>> plant;
  double supply;  // V, at most the plant's
  In<double, nb::shape<-1, kJoints, kOpen>> tunings;
  Chase chase;
};

loop::PlantRow row_of(const Task& task) {
  loop::PlantRow row;
  std::copy_n(task.plant.data(), loop::kPlantColumns, reinterpret_cast<double*>(&row));
  return row;
}

arm::State<double> at_rest(const double* home) {
  arm::State<double> s{};
  std::copy_n(home, kJoints, s.q);
  std::copy_n(home, kJoints, s.motor_q);
  return s;
}

// Mean squared errors (rad^2), and where wanted the angles (rad), at the beginning of every tick, under one tuning.
void simulate(const Task& task, std::size_t tuning, double* mse, double* angles) {
  static constexpr double kNoLoad[kJoints] = {};
  const loop::PlantRow row = row_of(task);
  ideal::Law law(row.plant, task.supply, reinterpret_cast<const ideal::Tuning*>(&task.tunings(tuning, 0, 0)), loop::kSlice);
  const Chase& chase = task.chase;
  const std::size_t slices = task.leader.shape(0);
  arm::State<double> s = at_rest(&task.leader(0, 0));
  bool arrived = false;
  for (std::size_t n = 0; n < slices; ++n) {
    const std::size_t known = n > task.late ? n - task.late : 0, before = known > 0 ? known - 1 : 0;
    double leader[kJoints], speed[kJoints], volts[kJoints];
    for (std::size_t i = 0; i < kJoints; ++i) {
      leader[i] = task.leader(known, i);
      speed[i] = (leader[i] - task.leader(before, i)) / loop::kSlice;
      if (n % loop::kSlices == 0) {
        const double error = task.leader(n, i) - s.q[i];
        mse[i] += error * error * static_cast<double>(loop::kSlices) / static_cast<double>(slices);
        if (angles) *angles++ = s.q[i];
      }
    }
    law.volts(s, leader, speed, volts);
    if (chase.joint < kJoints) {
      const int direction = chase.direction(n);
      arrived = direction != 0 && (arrived || direction * (s.q[chase.joint] - chase.until(n)) >= 0.0);
      if (direction != 0 && !arrived) volts[chase.joint] = direction * task.supply;
    }
    arm::advance(row.plant, s, volts, kNoLoad, loop::kSlice);
  }
}

void check(const Task& task) {
  const std::size_t slices = task.leader.shape(0);
  if (slices == 0 || slices % loop::kSlices != 0) throw std::invalid_argument("the leader must have whole ticks of four slices.");
  if (!(task.supply > 0.0)) throw std::invalid_argument("the supply must be above 0 V.");
  if (task.chase.direction.shape(0) != slices || task.chase.until.shape(0) != slices) {
    throw std::invalid_argument("direction and until need a value for every slice.");
  }
  for (std::size_t n = 0; n < task.tunings.shape(0) * kJoints; ++n) {
    const double* open = task.tunings.data() + n * kOpen;
    if (!(open[0] > 0.0 && open[1] > 0.0)) throw std::invalid_argument("brake and settle must be above 0.");
  }
}

nb::object array_of(std::unique_ptr<double[]> values, std::initializer_list<std::size_t> shape) {
  double* raw = values.release();
  nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double, nb::c_contig>(raw, shape, owner));
}

nb::tuple run(const Task& task, bool keep, int threads) {
  check(task);
  const std::size_t count = task.tunings.shape(0), ticks = keep ? task.leader.shape(0) / loop::kSlices : 0, size = ticks * kJoints;
  auto mse = std::make_unique<double[]>(count * kJoints);
  auto angles = std::make_unique<double[]>(count * size);
  {
    const nb::gil_scoped_release free;
    greywhale::share_out(count, threads, [&](std::size_t n) { simulate(task, n, &mse[n * kJoints], keep ? &angles[n * size] : nullptr); });
  }
  return nb::make_tuple(array_of(std::move(mse), {count, kJoints}), array_of(std::move(angles), {count, ticks, kJoints}));
}

}  // namespace

void bind_ideal(nb::module_& m) {
  m.def(
      "simulate_ideal",
      [](const In<double, nb::shape<-1, kJoints>>& leader, std::size_t late, const In<double, nb::shape<loop::kPlantColumns>>& plant,
         double supply, const In<double, nb::shape<-1, kJoints, kOpen>>& tunings, int chased,
         const In<std::int8_t, nb::shape<-1>>& direction, const In<double, nb::shape<-1>>& until, bool keep, int threads) {
        const std::size_t joint = chased < 0 ? kJoints : static_cast<std::size_t>(chased);
        return run({leader, late, plant, supply, tunings, {joint, direction, until}}, keep, threads);
      },
      nb::kw_only(), "leader"_a.noconvert(), "late"_a, "plant"_a.noconvert(), "supply"_a, "tunings"_a.noconvert(), "chased"_a,
      "direction"_a.noconvert(), "until"_a.noconvert(), "keep"_a, "threads"_a,
      "Mean squared errors (tunings, 4) of an arm under the ideal controller, one of its joints chasing if asked, and, to keep, its "
      "angles (tunings, ticks, 4). The GIL is released.");
}
