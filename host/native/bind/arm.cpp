// Binds sim/arm. greywhale.arm wraps these classes with validated parameters; use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/variant.h>

#include <array>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "arm/arm.h"
#include "arm/motor.h"
#include "arm/pot_faults.h"
#include "arm/potentiometer.h"
#include "arm/rigid_body.h"
#include "bindings.h"
#include "four.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace arm = greywhale::arm;

// A Python object as type hints show it: `out` is returned as it came, which nanobind cannot say by itself.
#define FOUR "numpy.typing.NDArray[numpy.float64]"
#define FOUR_IN "numpy.typing.NDArray[numpy.float64] | collections.abc.Sequence[float]"
#define STEP_SIGNATURE "def step(self, voltages: " FOUR_IN ", dt: float, out: " FOUR " | None = None) -> " FOUR
#define MILLIVOLTS_SIGNATURE "def millivolts(self, angles: " FOUR_IN ", out: " FOUR " | None = None) -> " FOUR

namespace {

using greywhale::bind::array_of;
using greywhale::bind::Copy;
using greywhale::bind::Four;
using greywhale::bind::In;
using greywhale::bind::Out;
using greywhale::bind::owned;
using Matrix = nb::ndarray<nb::numpy, double, nb::shape<arm::kJoints, arm::kJoints>, nb::c_contig>;
using ActuatorOfOne = arm::Actuator<double>;
using JointOfOne = arm::Joint<double>;
using Body = arm::RigidBody<double>;

// An array of the caller's to fill, for loops of many thousand calls a second; without one a fresh array is made.
using Writable = nb::ndarray<double, nb::shape<arm::kJoints>, nb::c_contig, nb::device::cpu>;

std::optional<Writable> target(nb::handle out) {
  if (out.is_none()) return std::nullopt;
  Writable array;
  if (!nb::try_cast(out, array, false))
    throw nb::type_error("out must be a writable, contiguous float64 array of four.");
  return array;
}

nb::object filled(nb::object out, const std::optional<Writable>& array, const Four& values) {
  if (!array) return nb::cast(array_of(values));
  std::memcpy(array->data(), values, sizeof values);
  return out;
}

using State = arm::State<double>;

template <Four State::* Member>
Out copy_of(const arm::Arm& self) {
  return array_of(self.state().*Member);
}

arm::Pose<double> pose_at(const In& in) {
  const Copy q(in);
  return arm::pose_of<double>(q.values[1], q.values[2]);
}

Matrix mass_matrix(const Body& body, const In& q) {
  double full[arm::kJoints * arm::kJoints];
  arm::fill_matrix(arm::geometry_of(body, pose_at(q)).mass, full);
  return owned<Matrix>(full, {arm::kJoints, arm::kJoints});
}

Out bias(const Body& body, const In& q, const In& v) {
  Four torque;
  arm::bias_torque(arm::geometry_of(body, pose_at(q)), Copy(v).values, torque);
  return array_of(torque);
}

double kinetic(const Body& body, const In& q, const In& v) {
  return arm::kinetic_energy(arm::geometry_of(body, pose_at(q)).mass, Copy(v).values);
}

double potential(const Body& body, const In& q) { return arm::potential_energy(body, pose_at(q)); }

void bind_parameters(nb::module_& m) {
  nb::class_<arm::Link>(m, "Link", "Mass properties of one link, SI units, inertias about its centre of mass.")
      .def(
          "__init__",
          [](arm::Link* self, double mass, double length, double centre, double ixx, double iyy, double izz) {
            new (self) arm::Link{mass, length, centre, ixx, iyy, izz};
          },
          nb::kw_only(), "mass"_a, "length"_a, "centre"_a, "ixx"_a, "iyy"_a, "izz"_a);

  nb::class_<ActuatorOfOne>(m, "Actuator", "A geared motor as its joint feels it.")
      .def_ro("torque_per_volt", &ActuatorOfOne::torque_per_volt, "N m/V at standstill")
      .def_ro("inertia", &ActuatorOfOne::inertia, "kg m^2, reflected to the joint")
      .def_ro("damping", &ActuatorOfOne::damping, "N m s, back-EMF and viscous friction")
      .def_ro("resistance", &ActuatorOfOne::resistance, "ohm, of winding and driver");
  const auto define_actuator = [&m](const char* name, ActuatorOfOne (*equation)(const arm::Motor&), const char* doc) {
    m.def(
        name,
        [equation](double inertia, double resistance, double torque_constant, double viscous, double gear_ratio) {
          return equation({inertia, resistance, torque_constant, viscous, gear_ratio});
        },
        nb::kw_only(), "inertia"_a, "resistance"_a, "torque_constant"_a, "viscous"_a, "gear_ratio"_a, doc);
  };
  define_actuator("physical_actuator", &arm::physical_actuator, "The physical gear-coupled motor equation.");
  define_actuator("paper_actuator", &arm::paper_actuator, "The paper's Eq. 1 as its units allow it.");

  nb::class_<JointOfOne>(m, "Joint", "Motor, friction, gear and stops of one joint, at its output shaft, SI units.")
      .def(
          "__init__",
          [](JointOfOne* self, const ActuatorOfOne& actuator, double coulomb, double breakaway,
             double stribeck_velocity, double load_friction, double creep_velocity, double half_gap, double stiffness,
             double damping, double drag, double min, double max, double pot_play, double pot_lag, double lost_up,
             double lost_down) {
            new (self) JointOfOne{actuator,
                                  {coulomb, breakaway, stribeck_velocity, load_friction, creep_velocity},
                                  {half_gap, stiffness, damping, drag},
                                  {min, max},
                                  {pot_play, pot_lag},
                                  {lost_up, lost_down}};
          },
          nb::kw_only(), "actuator"_a, "coulomb"_a, "breakaway"_a, "stribeck_velocity"_a, "load_friction"_a = 0.0,
          "creep_velocity"_a = 0.0, "half_gap"_a, "stiffness"_a, "damping"_a, "drag"_a, "min"_a, "max"_a,
          "pot_play"_a = 0.0, "pot_lag"_a = 0.0, "lost_up"_a = 0.0, "lost_down"_a = 0.0);

  nb::class_<arm::ArmParameters>(m, "ArmParameters", "The whole arm; greywhale.arm.ArmParameters makes it, validated.")
      .def(
          "__init__",
          [](arm::ArmParameters* self, const std::array<arm::Link, arm::kJoints>& links, double tip_mass,
             double gravity, const std::array<JointOfOne, arm::kJoints>& joints, double supply,
             double supply_resistance, int pwm_levels) {
            new (self) arm::ArmParameters{links, tip_mass, gravity, joints, {{supply, supply_resistance}, pwm_levels}};
          },
          nb::kw_only(), "links"_a, "tip_mass"_a, "gravity"_a, "joints"_a, "supply"_a, "supply_resistance"_a = 0.0,
          "pwm_levels"_a);
}

void bind_body(nb::module_& m) {
  nb::class_<Body>(m, "RigidBody",
                   "The links alone: M(q) q'' + bias(q, q') = torque. Arrays of four, rad and SI units.")
      .def("mass_matrix", &mass_matrix, "q"_a, "4x4, kg m^2")
      .def("bias", &bias, "q"_a, "v"_a, "Velocity and gravity torques, N m")
      .def("kinetic_energy", &kinetic, "q"_a, "v"_a, "J")
      .def("potential_energy", &potential, "q"_a, "J, zero with the arm level");
}

void bind_motion(nb::module_& m) {
  nb::class_<arm::Arm>(m, "Arm", "The follower arm: four voltages in, four joint angles out.")
      .def(nb::init<const arm::ArmParameters&, std::uint64_t, double>(), "parameters"_a, "seed"_a = 0,
           "longest_step"_a = arm::Arm::kLongestStep)
      .def(
          "step",
          [](arm::Arm& self, const In& voltages, double dt, nb::object out) {
            const std::optional<Writable> array = target(out);
            self.step(Copy(voltages).values, dt);
            return filled(std::move(out), array, self.state().q);
          },
          "voltages"_a, "dt"_a, "out"_a = nb::none(), nb::sig(STEP_SIGNATURE),
          "Hold the voltages (V) for dt seconds; the joint angles (rad) then, in `out` or a fresh array.")
      .def(
          "reset", [](arm::Arm& self, const In& angles) { self.reset(Copy(angles).values); }, "angles"_a,
          "At rest at these angles (rad).")
      .def(
          "set_load", [](arm::Arm& self, const In& torques) { self.set_load(Copy(torques).values); }, "torques"_a,
          "Outside torques (N m) on the links from now on.")
      .def_prop_ro("angles", copy_of<&State::q>, nb::rv_policy::move, "rad")
      .def_prop_ro("velocities", copy_of<&State::v>, nb::rv_policy::move, "rad/s")
      .def_prop_ro("motor_angles", copy_of<&State::motor_q>, nb::rv_policy::move,
                   "rad at the output shaft; differ from the angles by backlash and tooth bending")
      .def_prop_ro("motor_velocities", copy_of<&State::motor_v>, nb::rv_policy::move, "rad/s at the output shaft")
      .def_prop_ro("kinetic_energy", &arm::Arm::kinetic_energy, "J, links and motors")
      .def_prop_ro("potential_energy", &arm::Arm::potential_energy, "J, gravity and teeth")
      .def_prop_ro("body", &arm::Arm::body, nb::rv_policy::reference_internal)
      .def_prop_ro("steps", &arm::Arm::steps, "Integration steps so far")
      .def_prop_ro("unsettled_steps", &arm::Arm::unsettled_steps,
                   "Those whose contact conditions were not settled; 0 is normal");
}

void bind_pots(nb::module_& m) {
  nb::enum_<arm::Wiring>(m, "Wiring", "The place that a potentiometer's wiper leads to.")
      .value("CONNECTED", arm::Wiring::connected)
      .value("OPEN", arm::Wiring::open, "wire off: the pull-down reads 0 V")
      .value("SHORTED", arm::Wiring::shorted, "wiper on the supply");

  nb::class_<arm::Potentiometer>(m, "Potentiometer")
      .def(
          "__init__",
          [](arm::Potentiometer* self, double track, double centre, double direction, double noise, double linearity,
             double play,
             double lag) { new (self) arm::Potentiometer{track, centre, direction, noise, linearity, {play, lag}}; },
          nb::kw_only(), "track"_a, "centre"_a, "direction"_a, "noise"_a, "linearity"_a, "play"_a = 0.0, "lag"_a = 0.0);

  nb::class_<arm::Potentiometers>(m, "Potentiometers", "Four joint potentiometers.")
      .def(nb::init<const std::array<arm::Potentiometer, arm::kJoints>&, double, std::uint64_t>(), "pots"_a, "supply"_a,
           "seed"_a = 0)
      .def(
          "millivolts",
          [](arm::Potentiometers& self, const In& angles, nb::object out) {
            const std::optional<Writable> array = target(out);
            Four values;
            self.millivolts(Copy(angles).values, values);
            return filled(std::move(out), array, values);
          },
          "angles"_a, "out"_a = nb::none(), nb::sig(MILLIVOLTS_SIGNATURE),
          "Wiper voltages in mV, 0 to the supply, in `out` or a fresh array; each call draws new noise.")
      .def(
          "counts",
          [](arm::Potentiometers& self, const In& angles, int bits) {
            if (bits < 1 || bits > 24) throw nb::value_error("the converter must have 1 to 24 bits.");
            Four out;
            self.counts(Copy(angles).values, bits, out);
            return array_of(out);
          },
          "angles"_a, "bits"_a = 10, "Counts of a converter whose reference is the supply.")
      .def("set_wiring", &arm::Potentiometers::set_wiring, "joint"_a, "wiring"_a)
      .def("wiring", &arm::Potentiometers::wiring, "joint"_a);
}

void bind_pot_faults(nb::module_& m) {
  nb::enum_<arm::PotFault>(m, "PotFault", "A fault of a potentiometer.")
      .value("FROZEN", arm::PotFault::frozen)
      .value("SLIPPING", arm::PotFault::slipping, "its shaft, with every way up")
      .value("LOOSE", arm::PotFault::loose, "the wire is off for 2 ms again and again")
      .value("NOISY", arm::PotFault::noisy)
      .value("HUMMING", arm::PotFault::humming)
      .value("REVERSED", arm::PotFault::reversed, "the two ends of the track are exchanged")
      .value("DEAD_ZONE", arm::PotFault::dead_zone, "the dead zone lies in its travel")
      .value("CROSSED", arm::PotFault::crossed, "the wiper's wire and an end's are exchanged");

  using Millivolts = nb::ndarray<double, nb::shape<arm::kPots>, nb::c_contig, nb::device::cpu>;
  nb::class_<arm::PotFaults>(m, "PotFaults",
                             "Mistakes between the potentiometers, 0..3 leader and 4..7 follower, and the converter.")
      .def(nb::init<>())
      .def(
          "inject",
          [](arm::PotFaults& self, std::size_t pot, std::optional<arm::PotFault> kind) {
            self.inject(pot, kind.value_or(arm::PotFault::none));
          },
          "pot"_a, "kind"_a.none(), "Give it this fault from now on; None mends it.")
      .def("swap", &arm::PotFaults::swap, "one"_a, "other"_a, "Exchange the wires of two inputs.")
      .def("touch", &arm::PotFaults::touch, "one"_a, "other"_a, "Let the wipers' wires of two potentiometers touch.")
      .def_prop_ro("any", &arm::PotFaults::any, "True if anything is wrong.")
      .def(
          "apply",
          [](arm::PotFaults& self, const Millivolts& millivolts) {
            arm::Millivolts values;
            std::memcpy(values.data(), millivolts.data(), sizeof values);
            self.apply(values);
            std::memcpy(millivolts.data(), values.data(), sizeof values);
          },
          "millivolts"_a, "Change the voltages (8,) mV in place, once a slice of 250 us.");
}

}  // namespace

void bind_arm(nb::module_& m) {
  bind_parameters(m);
  bind_body(m);
  bind_motion(m);
  bind_pots(m);
  bind_pot_faults(m);
  m.def("logarithm", &arm::logarithm, "x"_a, "The natural logarithm of x > 0, the same bits with every C library.");
}
