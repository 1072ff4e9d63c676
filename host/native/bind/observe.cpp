// Binds the observer of external torques (observe/). greywhale.measure.torque wraps it; use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "arrays.h"
#include "bindings.h"
#include "observe/observer.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace loop = greywhale::loop;
namespace observe = greywhale::observe;

namespace {

using greywhale::bind::Array;
using greywhale::bind::In;
using observe::kJoints;
using Plants = In<double, nb::shape<-1, loop::kPlantColumns>>;
using Limits = In<double, nb::shape<sizeof(observe::Limits) / sizeof(double)>>;
using Rows = In<double, nb::shape<-1, kJoints>>;

void create(observe::Ensemble* self, const Plants& plants, const Limits& limits,
            const std::array<double, kJoints>& noise, double delay_s) {
  if (plants.shape(0) == 0) throw std::invalid_argument("plants need a row.");
  observe::Four each;
  std::copy(noise.begin(), noise.end(), each);
  new (self) observe::Ensemble(reinterpret_cast<const loop::PlantRow*>(plants.data()), plants.shape(0),
                               *reinterpret_cast<const observe::Limits*>(limits.data()), each, delay_s);
}

nb::tuple feed(observe::Ensemble& self, const In<double, nb::shape<-1>>& time, const Rows& angles, const Rows& volts) {
  const std::size_t count = time.shape(0);
  if (angles.shape(0) != count || volts.shape(0) != count)
    throw std::invalid_argument("time, angles and volts differ in length.");
  Array<double> torque({count, kJoints}), half({count, kJoints});
  Array<std::uint8_t> sight({count, kJoints});
  Array<bool> contact({count, kJoints});
  observe::Four q, u;
  observe::Seen seen[kJoints];
  for (std::size_t n = 0; n < count; ++n) {
    std::copy_n(&angles(n, 0), kJoints, q);
    std::copy_n(&volts(n, 0), kJoints, u);
    self.step(time(n), q, u, seen);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t place = n * kJoints + i;
      torque.data()[place] = seen[i].torque;
      half.data()[place] = seen[i].half_width;
      sight.data()[place] = static_cast<std::uint8_t>(seen[i].sight);
      contact.data()[place] = seen[i].contact;
    }
  }
  return nb::make_tuple(torque.numpy(), half.numpy(), sight.numpy(), contact.numpy());
}

}  // namespace

void bind_observe(nb::module_& m) {
  nb::class_<observe::Ensemble>(m, "TorqueObserver", "Outside torques of arms that could have made the samples.")
      .def("__init__", &create, "plants"_a.noconvert(), "limits"_a.noconvert(), "noise"_a, "delay_s"_a)
      .def("restart", &observe::Ensemble::restart, "Begin anew with the next sample.")
      .def("feed", &feed, "time"_a.noconvert(), "angles"_a.noconvert(), "volts"_a.noconvert(),
           nb::sig("def feed(self, time: numpy.typing.NDArray[numpy.float64], "
                   "angles: numpy.typing.NDArray[numpy.float64], volts: numpy.typing.NDArray[numpy.float64]) -> "
                   "tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], "
                   "numpy.typing.NDArray[numpy.uint8], numpy.typing.NDArray[numpy.bool_]]"),
           "Torques and half widths, N m, sights and contacts, (n, 4) each, of samples (n,) s and (n, 4) rad and V.");
}
