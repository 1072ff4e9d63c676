// The power of recorded angles in a band (closed_loop/band_power.h). greywhale.loop.band designs the filter; use
// that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <stdexcept>

#include "arrays.h"
#include "bindings.h"
#include "closed_loop/band_power.h"
#include "closed_loop/experiment.h"
#include "share_out.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace loop = greywhale::loop;

namespace {

using greywhale::bind::Array;
using greywhale::bind::In;
using loop::kJoints;

constexpr std::size_t kNumbers = 6;  // of a section: b0, b1, b2, a0 = 1, a1, a2

loop::Section<kJoints> section(const double* n) { return {n[0], n[1], n[2], n[4], n[5]}; }

// Mean squares (n x blocks x 4) of angles (n x rows x 4), of which every `stride`-th row counts.
template <class T>
nb::object band_power(const In<T, nb::shape<-1, -1, kJoints>>& angles, std::size_t stride, std::size_t length,
                      const In<double, nb::shape<2, kNumbers>>& sections) {
  if (stride == 0 || length == 0) throw std::invalid_argument("stride and length must be 1 or more.");
  const std::size_t count = angles.shape(0), rows = angles.shape(1);
  const std::size_t blocks = (rows + stride - 1) / stride / length;
  Array<double> power({count, blocks, kJoints});
  {
    const nb::gil_scoped_release free;
    const loop::Section<kJoints> low = section(sections.data()), high = section(sections.data() + kNumbers);
    greywhale::share_out(count, 0, [&](std::size_t n) {
      loop::band_power(angles.data() + n * rows * kJoints, stride, blocks, length, low, high,
                       power.data() + n * blocks * kJoints);
    });
  }
  return power.numpy();
}

}  // namespace

void bind_band_power(nb::module_& m) {
  m.def("band_power", &band_power<float>, "angles"_a.noconvert(), "stride"_a, "length"_a, "sections"_a.noconvert(),
        "The mean square in a band, n x blocks x 4, of angles n x rows x 4; every stride-th row, length rows a block.");
  m.def("band_power", &band_power<double>, "angles"_a.noconvert(), "stride"_a, "length"_a, "sections"_a.noconvert());
}
