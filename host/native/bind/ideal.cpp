// The arm under an ideal controller (ideal/law.h), for many tunings of it. greywhale.tune.judge.floor searches among
// them; use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

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
#include "ideal/simulate.h"

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

using Leader = In<double, nb::shape<-1, kJoints>>;
using Tunings = In<double, nb::shape<-1, kJoints, kOpen>>;

void check(const ideal::Experiment& x, const Tunings& tunings) {
  if (x.slices == 0 || x.slices % loop::kSlices != 0)
    throw std::invalid_argument("the leader must have whole ticks of four slices.");
  if (!(x.supply > 0.0)) throw std::invalid_argument("the supply must be above 0 V.");
  for (std::size_t n = 0; n < tunings.shape(0) * kJoints; ++n) {
    const double* open = tunings.data() + n * kOpen;
    if (!(open[0] > 0.0 && open[1] > 0.0)) throw std::invalid_argument("brake and settle must be above 0.");
  }
}

nb::object array_of(std::unique_ptr<double[]> values, std::initializer_list<std::size_t> shape) {
  double* raw = values.release();
  nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double, nb::c_contig>(raw, shape, owner));
}

nb::tuple run(const ideal::Experiment& x, const Tunings& tunings, bool keep, int threads) {
  check(x, tunings);
  const std::size_t count = tunings.shape(0), ticks = keep ? x.slices / loop::kSlices : 0;
  auto mse = std::make_unique<double[]>(count * kJoints);
  auto angles = std::make_unique<double[]>(count * ticks * kJoints);
  {
    const nb::gil_scoped_release free;
    ideal::simulate(x, reinterpret_cast<const ideal::Tuning*>(tunings.data()), count, threads, mse.get(),
                    keep ? angles.get() : nullptr);
  }
  return nb::make_tuple(array_of(std::move(mse), {count, kJoints}),
                        array_of(std::move(angles), {count, ticks, kJoints}));
}

}  // namespace

void bind_ideal(nb::module_& m) {
  m.def(
      "simulate_ideal",
      [](const Leader& leader, std::size_t late, const In<double, nb::shape<loop::kPlantColumns>>& plant, double supply,
         const Tunings& tunings, int chased, const In<std::int8_t, nb::shape<-1>>& direction,
         const In<double, nb::shape<-1>>& until, bool keep, int threads) {
        if (direction.shape(0) != leader.shape(0) || until.shape(0) != leader.shape(0)) {
          throw std::invalid_argument("direction and until need a value for every slice.");
        }
        const ideal::Chase chase{chased < 0 ? kJoints : static_cast<std::size_t>(chased), direction.data(),
                                 until.data()};
        return run({leader.data(), leader.shape(0), late, plant.data(), supply, chase}, tunings, keep, threads);
      },
      nb::kw_only(), "leader"_a.noconvert(), "late"_a, "plant"_a.noconvert(), "supply"_a, "tunings"_a.noconvert(),
      "chased"_a, "direction"_a.noconvert(), "until"_a.noconvert(), "keep"_a, "threads"_a,
      "Mean squared errors (tunings, 4) of an arm under the ideal controller, one of its joints chasing if asked, and, "
      "to keep, its "
      "angles (tunings, ticks, 4). The GIL is released.");
}
