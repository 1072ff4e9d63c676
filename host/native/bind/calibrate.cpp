// The rules of a calibration by hand (calibrate/rules.h). greywhale.board.calibrate asks them; use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>

#include "bindings.h"
#include "calibrate/rules.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace calibrate = greywhale::calibrate;

namespace {

using In = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

constexpr struct {
  const char* name;
  calibrate::Answer (*rule)(calibrate::Given);
} kRules[] = {
    {"counts", calibrate::counts},
    {"sweep", calibrate::sweep},
    {"held", calibrate::held},
    {"solve", calibrate::solve},
    {"match", calibrate::match},
    {"require_apart", calibrate::require_apart},
    {"slipped", calibrate::slipped},
    {"apart", calibrate::apart},
    {"raw", calibrate::raw},
    {"motor", calibrate::motor},
    {"pulse", calibrate::pulse},
    {"remarks", calibrate::remarks},
    {"positive_way", calibrate::positive_way},
    {"turn_asked", calibrate::turn_asked},
    {"ready_asked", calibrate::ready_asked},
};

nb::tuple calibration_rule(const std::string& name, const In& given) {
  const auto* found =
      std::find_if(std::begin(kRules), std::end(kRules), [&](const auto& one) { return name == one.name; });
  if (found == std::end(kRules)) throw std::invalid_argument("a calibration has no rule " + name + ".");
  const calibrate::Answer answer = found->rule({given.data(), given.size()});
  auto numbers = std::make_unique<double[]>(answer.numbers.size());
  std::copy(answer.numbers.begin(), answer.numbers.end(), numbers.get());
  double* raw = numbers.release();
  const nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  const std::size_t shape[] = {answer.numbers.size()};
  return nb::make_tuple(nb::ndarray<nb::numpy, double, nb::c_contig>(raw, 1, shape, owner), answer.words);
}

}  // namespace

void bind_calibrate(nb::module_& m) {
  m.def("calibration_rule", &calibration_rule, "name"_a, "given"_a.noconvert(),
        nb::sig("def calibration_rule(name: str, given: numpy.typing.NDArray[numpy.float64]) -> "
                "tuple[numpy.typing.NDArray[numpy.float64], str]"),
        "What a rule answers to numbers: numbers, and words; calibrate/rules.h says which.");
  m.attr("CALIBRATION_MARGIN_RAD") = calibrate::kMargin;
  nb::list shares;
  for (const double share : calibrate::kPulseShares) shares.append(share);
  m.attr("PULSE_SHARES") = nb::tuple(shares);
}
