// The arm's own functions (arm/elementary.h) for arrays. greywhale.base.elementary has them for all; use that, not
// this.
#include "arm/elementary.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "bindings.h"

namespace nb = nanobind;
namespace arm = greywhale::arm;
using namespace nb::literals;

namespace {

using In = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

template <double (*function)(double)>
nb::object of_each(const In& x) {
  auto values = std::make_unique<double[]>(x.size());
  std::transform(x.data(), x.data() + x.size(), values.get(), function);
  std::vector<std::size_t> shape(x.ndim());
  for (std::size_t axis = 0; axis < x.ndim(); ++axis) shape[axis] = x.shape(axis);
  double* raw = values.release();
  const nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, double, nb::c_contig>(raw, shape.size(), shape.data(), owner));
}

}  // namespace

void bind_elementary(nb::module_& m) {
  m.def("exponential", &of_each<arm::exponential>, "x"_a.noconvert());
  m.def("logarithm", &of_each<arm::logarithm>, "x"_a.noconvert());
  m.def("cosine", &of_each<arm::cosine>, "x"_a.noconvert());
}
