// Binds sim/bench/drivers.h. greywhale_sim wraps these classes; use that, not this.
#include "bench/drivers.h"

#include <nanobind/nanobind.h>

#include "bindings.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace bench = greywhale::bench;

void bind_drivers(nb::module_& m) {
  using bench::Bridge;
  using bench::Chip;
  nb::enum_<Chip>(m, "DriverChip", "What a motor driver makes of its pins.")
      .value("SIGN_MAGNITUDE", Chip::sign_magnitude)
      .value("TB6612", Chip::tb6612)
      .value("L298N", Chip::l298n)
      .value("TWO_INPUTS", Chip::two_inputs)
      .value("TWO_INPUTS_NSLEEP", Chip::two_inputs_nsleep)
      .value("HALF_BRIDGES", Chip::half_bridges)
      .value("ALWAYS_ON", Chip::always_on);
  nb::class_<Bridge>(m, "Bridge",
                     "Shares of a PWM period in which it puts the supply on a motor, either way, and shorts it. The "
                     "rest of the time the motor coasts.")
      .def(
          "__init__",
          [](Bridge* self, double forwards, double backwards, double shorted) {
            new (self) Bridge{forwards, backwards, shorted};
          },
          "forwards"_a, "backwards"_a, "shorted"_a)
      .def_ro("forwards", &Bridge::forwards)
      .def_ro("backwards", &Bridge::backwards)
      .def_ro("shorted", &Bridge::shorted)
      .def_prop_ro("duty", &Bridge::duty);
  m.def(
      "bridge_of",
      [](Chip chip, bool enable, double pwm, bool direction, double second_pwm, bool second_direction) {
        return bench::bridge_of(chip, {enable, pwm, direction, second_pwm, second_direction});
      },
      "chip"_a, nb::kw_only(), "enable"_a, "pwm"_a, "direction"_a, "second_pwm"_a, "second_direction"_a);
  m.def("mean_volts", &bench::mean_volts, "bridge"_a, "supply_v"_a, "emf_v"_a,
        "The voltage that would drive the same mean current through a motor as this bridge does, V.");
}
