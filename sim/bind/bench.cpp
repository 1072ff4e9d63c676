// Binds sim/bench. greywhale_sim wraps these classes; use that, not this.
#include "bench/bench.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

#include "bench/simulated_board.h"
#include "bindings.h"
#include "four.h"
#include "py_board.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace arm = greywhale::arm;
namespace bench = greywhale::bench;
using greywhale::bind::array_of;
using greywhale::bind::Copy;
using greywhale::bind::In;
using greywhale::bind::Out;
using greywhale::bind::PyBoard;

namespace {

using MaybeIn = std::optional<In>;
using Rows = nb::ndarray<const double, nb::shape<-1, arm::kJoints>, nb::c_contig, nb::device::cpu>;
using Values = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::optional<bench::Four> maybe(const MaybeIn& in) {
  return in ? std::optional<bench::Four>(Copy(*in).array()) : std::nullopt;
}

nb::object maybe(const std::optional<bench::Four>& four) { return four ? nb::cast(array_of(*four)) : nb::none(); }

template <std::size_t N>
nb::object view_of(std::array<double, N>& values, nb::handle owner) {
  return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>>(values.data(), {N}, owner));
}

nb::object copy_of(const double* values, std::size_t count) {
  using Copied = nb::ndarray<nb::numpy, const double, nb::ndim<1>>;
  return nb::cast(Copied(values, {count}), nb::rv_policy::copy);
}

template <std::size_t N>
nb::object copy_of(const std::array<double, N>& values) {
  return copy_of(values.data(), N);
}

// Whoever gives a board or a plant keeps it alive: Python's collector must see that, and cannot see what C++ holds.
class ForeignBoard : public bench::BoardSeam {
 public:
  ForeignBoard(nb::handle board, const bench::Wiring& wiring) : board_(board) {
    watch(wiring.enable);
    for (const auto& motors : {std::optional(wiring.motors), wiring.second}) {
      if (!motors) continue;
      for (const bench::MotorWires& motor : *motors)
        board_.attr("add_duty_output")(motor.pwm.timer, std::string(1, motor.pwm.channel));
      for (const bench::MotorWires& motor : *motors) watch(motor.direction);
    }
  }
  std::uint64_t cycle() override { return nb::cast<std::uint64_t>(board_.attr("cycle")); }
  void read_pins(bench::Pins& pins) override {
    const auto values = nb::cast<Values>(board_.attr("outputs")());
    std::copy_n(values.data(), std::min(pins.size(), values.shape(0)), pins.begin());
  }
  void hold_low(bench::Pin pin) override { board_.attr("hold_pin")(std::string(1, pin.port), pin.bit, false); }
  void let_go(bench::Pin pin) override { board_.attr("let_pin_go")(std::string(1, pin.port), pin.bit); }
  void set_millivolts(const arm::Millivolts& millivolts) override {
    board_.attr("set_millivolts")(copy_of(millivolts));
  }
  void set_floating(unsigned inputs) override { board_.attr("set_floating")(inputs); }
  void set_joined(unsigned inputs, unsigned wipers) override { board_.attr("set_joined")(inputs, wipers); }
  void set_supply(unsigned millivolts) override { board_.attr("set_supply")(millivolts); }
  bool run_until(std::uint64_t cycle) override {
    return nb::cast<int>(board_.attr("run_until")(cycle)) != static_cast<int>(board::RunState::crashed);
  }

 private:
  void watch(bench::Pin pin) { board_.attr("add_pin_output")(std::string(1, pin.port), pin.bit); }

  nb::handle board_;
};

class ForeignPlant : public bench::Plant {
 public:
  explicit ForeignPlant(nb::handle plant) : plant_(plant) {}
  void step(const bench::Four& volts, double dt, bench::Four& angles) override {
    angles = Copy(nb::cast<In>(plant_.attr("step")(copy_of(volts), dt))).array();
  }
  bool place(bench::Four& angles) override {
    if (!nb::hasattr(plant_, "reset")) return false;
    plant_.attr("reset")(copy_of(angles));
    return true;
  }
  bench::Four motor_velocities() override {
    if (!nb::hasattr(plant_, "motor_velocities")) return {};
    return Copy(nb::cast<In>(plant_.attr("motor_velocities"))).array();
  }

 private:
  nb::handle plant_;
};

std::unique_ptr<bench::BoardSeam> seam_of(nb::handle board, const bench::Wiring& wiring) {
  PyBoard* ours = nullptr;
  if (nb::try_cast(board, ours)) return std::make_unique<bench::SimulatedBoard>(*ours, wiring);
  return std::make_unique<ForeignBoard>(board, wiring);
}

// What a bench stands on, made before it.
struct Ground {
  Ground(nb::handle board, const bench::Wiring& wiring, nb::handle plant, std::uint64_t seed)
      : seam(seam_of(board, wiring)) {
    arm::ArmParameters* parameters = nullptr;
    if (nb::try_cast(plant, parameters)) own = std::make_unique<bench::OwnArm>(*parameters, seed);
    else foreign = std::make_unique<ForeignPlant>(plant);
  }
  std::unique_ptr<bench::BoardSeam> seam;
  std::unique_ptr<bench::OwnArm> own;
  std::unique_ptr<ForeignPlant> foreign;
};

class PyBench : private Ground, public bench::Bench {
 public:
  PyBench(nb::handle board, const bench::Wiring& wiring, bench::Person& person, nb::handle plant,
          const bench::Pots& pots, std::uint64_t seed, const bench::Electrics& electrics)
      : Ground(board, wiring, plant, seed),
        Bench(*seam, wiring, person, own ? static_cast<bench::Plant&>(*own) : *foreign, own.get(), pots, seed,
              electrics) {}

  bench::OwnArm& require_own_arm() {
    if (!own_arm()) throw nb::type_error("this follower is not the bench's own arm");
    return *own_arm();
  }
};

bool run(PyBench& self, std::uint64_t count, const nb::object& trace) {
  if (trace.is_none()) return self.run_slices(count);
  const nb::object angles = view_of(self.angles(), nb::find(self));
  self.set_trace([&](std::uint64_t cycle, const bench::Pins& pins) {
    trace(cycle, copy_of(pins.data(), self.pin_count()), angles);
  });
  try {
    const bool runs = self.run_slices(count);
    self.set_trace({});
    return runs;
  } catch (...) {
    self.set_trace({});
    throw;
  }
}

bench::Motion motion_of(std::uint64_t rows, nb::callable read) {
  return {rows, [read = std::move(read)](std::uint64_t first, std::vector<bench::Four>& piece) {
            const auto found = nb::cast<Rows>(read(first, piece.size()));
            if (found.shape(0) != piece.size()) throw nb::value_error("a motion gave another number of rows");
            for (std::size_t row = 0; row < piece.size(); ++row)
              std::copy_n(found.data() + row * arm::kJoints, arm::kJoints, piece[row].begin());
          }};
}

using Place = std::tuple<MaybeIn, MaybeIn, std::uint64_t>;

void bind_person(nb::module_& m) {
  nb::class_<bench::Person>(m, "Person", "The person at the bench, who leads the leader arm and holds the follower.")
      .def(
          "__init__",
          [](bench::Person* self, std::uint64_t rows, nb::callable read, double slice_s, double start_s,
             unsigned in_use) { new (self) bench::Person(motion_of(rows, std::move(read)), slice_s, start_s, in_use); },
          "rows"_a, "read"_a, "slice_s"_a, "start_s"_a = bench::Person::kStart, "in_use"_a = bench::Person::kAllJoints,
          "`read(first, count)` gives that many rows (count, 4) rad of the motion, one for each slice.")
      .def(
          "take_up_rows",
          [](bench::Person& self, std::uint64_t rows, nb::callable read) {
            self.take_up(motion_of(rows, std::move(read)));
          },
          "rows"_a, "read"_a)
      .def(
          "lead", [](bench::Person& self, const In& angles) { self.lead(Copy(angles).array()); }, "angles"_a,
          "Lead to angles (4,) rad, now, whether the motors are on or off, and to others when this is called again.")
      .def(
          "bring_slices",
          [](bench::Person& self, const std::vector<Place>& places) {
            std::vector<bench::Person::Place> wanted;
            for (const auto& [leader, follower, slices] : places)
              wanted.push_back({maybe(leader), maybe(follower), slices});
            self.bring_along(std::move(wanted));
          },
          "places"_a)
      .def("turn", &bench::Person::turn, "pot"_a, "each_way_s"_a = bench::Person::kEachWay,
           "Turn the joint of a potentiometer (0..3 leader, 4..7 follower) to both ends and back, the positive end "
           "first; how many seconds that takes.")
      .def(
          "pose", [](bench::Person& self, const In& angles) { return self.pose(Copy(angles).array()); }, "angles"_a,
          "Hold both arms at angles (4,) rad; how many seconds it takes to get there.")
      .def("hang", &bench::Person::hang, "Let the follower hang; how many seconds that takes.")
      .def("set_patience", &bench::Person::set_patience, "slices"_a,
           "Motors that are off for less than so many slices do not end the work: the person waits where they are.")
      .def(
          "step", [](bench::Person& self, bool on, const In& at) { self.step(on, Copy(at).array()); }, "enabled"_a,
          "follower"_a, "Advance one slice; `follower` is where the follower is now.")
      .def_prop_ro(
          "angles", [](const bench::Person& self) { return array_of(self.angles()); }, nb::rv_policy::move)
      .def_prop_rw(
          "hold", [](const bench::Person& self) { return maybe(self.hold); },
          [](bench::Person& self, const MaybeIn& pose) { self.hold = maybe(pose); }, nb::for_setter("pose"_a.none()),
          nb::for_getter(nb::sig("def hold(self) -> numpy.typing.NDArray[numpy.float64] | None")))
      .def_prop_ro(
          "home", [](const bench::Person& self) { return array_of(self.home()); }, nb::rv_policy::move)
      .def_prop_ro(
          "rest",
          [](const bench::Person& self) {
            return std::tuple(array_of(self.rest().leader), array_of(self.rest().follower));
          },
          nb::rv_policy::move)
      .def_prop_ro("plays", &bench::Person::plays)
      .def_prop_ro("finished", &bench::Person::finished, "The motion was played to its end since the motors went on.")
      .def_prop_ro("on_the_way", &bench::Person::on_the_way, "True while the hands have places to go to.")
      .def_prop_ro_static(
          "ENDS", [](nb::handle) { return std::tuple(bench::Person::kEnds[0], bench::Person::kEnds[1]); },
          "The ends of a sweep, rad, the positive one first.")
      .def_prop_ro_static(
          "HANGING", [](nb::handle) { return array_of(bench::Person::kHanging); }, nb::rv_policy::move)
      .def_prop_ro_static("EACH_WAY_S", [](nb::handle) { return bench::Person::kEachWay; });
}

using PinOf = std::tuple<char, unsigned>;
using PwmOf = std::tuple<unsigned, char>;
using MotorOf = std::tuple<PwmOf, PinOf>;
using MotorsOf = std::array<MotorOf, arm::kJoints>;

bench::Pin pin_of(const PinOf& pin) { return {std::get<0>(pin), std::get<1>(pin)}; }

std::array<bench::MotorWires, arm::kJoints> motors_of(const MotorsOf& motors) {
  std::array<bench::MotorWires, arm::kJoints> wires{};
  for (std::size_t i = 0; i < wires.size(); ++i) {
    const auto& [pwm, direction] = motors[i];
    wires[i] = {{std::get<0>(pwm), std::get<1>(pwm)}, pin_of(direction)};
  }
  return wires;
}

void bind_parts(nb::module_& m) {
  nb::class_<bench::Wiring>(m, "BenchWiring", "Pins of a board: ports with bits, timers with channels.")
      .def(
          "__init__",
          [](bench::Wiring* self, const PinOf& enable, const MotorsOf& motors, const std::optional<MotorsOf>& second,
             const PinOf& estop, const PinOf& clutch) {
            new (self) bench::Wiring{pin_of(enable), motors_of(motors), {}, pin_of(estop), pin_of(clutch)};
            if (second) self->second = motors_of(*second);
          },
          "enable"_a, "motors"_a, "second"_a.none(), "estop"_a, "clutch"_a);
  using FourPots = std::array<arm::Potentiometer, arm::kJoints>;
  nb::class_<bench::Pots>(m, "BenchPots", "Potentiometers of both arms, and their supplies in V.")
      .def(
          "__init__",
          [](bench::Pots* self, const FourPots& leader, double leader_supply, const FourPots& follower,
             double follower_supply) { new (self) bench::Pots{leader, follower, leader_supply, follower_supply}; },
          "leader"_a, "leader_supply"_a, "follower"_a, "follower_supply"_a);
  nb::class_<bench::Electrics>(m, "BenchElectrics",
                               "Drivers' chip, motors' supply in V, V s of each motor, joints in use as bits.")
      .def(
          "__init__",
          [](bench::Electrics* self, bench::Chip chip, double supply, const In& emf, unsigned in_use) {
            new (self) bench::Electrics{chip, supply, Copy(emf).array(), in_use};
          },
          "chip"_a, "supply"_a, "emf"_a, "in_use"_a);
}

using BenchClass = nb::class_<PyBench>;

void bind_faults(BenchClass& c) {
  c.def(
       "inject",
       [](PyBench& self, std::size_t pot, std::optional<arm::PotFault> kind) {
         self.inject(pot, kind.value_or(arm::PotFault::none));
       },
       "pot"_a, "kind"_a.none(), "Give a potentiometer this fault from now on; None mends it.")
      .def("swap", &PyBench::swap, "one"_a, "other"_a, "Exchange the wires of two inputs.")
      .def("touch", &PyBench::touch, "one"_a, "other"_a, "Let the wires of two potentiometers' wipers touch.")
      .def("set_wiring", &PyBench::set_wiring, "pot"_a, "wiring"_a)
      .def("let_float", &PyBench::let_float, "pot"_a, "floats"_a,
           "Take the wire off a potentiometer without a pull-down, or put it back.")
      .def("wire_motor", &PyBench::wire_motor, "joint"_a, "gain"_a, "driver"_a,
           "Put a motor on a driver (0..3), the right way (1), the wrong way (-1), a wire off (0), or weak (0.2).")
      .def("change_supply", &PyBench::change_supply, "volts"_a, "Give the motors another supply.")
      .def("share_supply", &PyBench::share_supply, "Let the board live on the motors' supply.")
      .def("mend", &PyBench::mend, "Wire everything rightly again.")
      .def("scale_noise", &PyBench::scale_noise, "times"_a, "Noise of the potentiometers, times their own.")
      .def("press_estop", &PyBench::press_estop, "pressed"_a, "The emergency stop, which closes to ground.")
      .def("press_clutch", &PyBench::press_clutch, "pressed"_a, "The clutch's pedal, which closes to ground.")
      .def_prop_ro("estop_pressed", &PyBench::estop_pressed)
      .def_prop_ro("clutch_pressed", &PyBench::clutch_pressed)
      .def_prop_ro("supply_v", &PyBench::supply)
      .def_prop_ro("floating", &PyBench::floating,
                   "Bit i: the wire of potentiometer i is off, nothing pulls its input.")
      .def_prop_ro("has_pot_faults", &PyBench::has_pot_faults)
      .def_prop_ro("shares_supply", &PyBench::shares_supply)
      .def_prop_ro("motor_gains", [](const PyBench& b) { return nb::list(nb::cast(b.motor_gains())); })
      .def_prop_ro("motor_drivers", [](const PyBench& b) { return nb::list(nb::cast(b.motor_drivers())); })
      .def("pot_wiring", &PyBench::pot_wiring, "pot"_a);
}

void bind_arm_of(BenchClass& c) {
  c.def(
       "become_own", [](PyBench& self, const arm::ArmParameters& arm) { self.require_own_arm().become(arm); }, "arm"_a,
       "Let the arm be another one.")
      .def(
          "load_own_tip", [](PyBench& self, double kg) { self.require_own_arm().load_tip(kg); }, "mass_kg"_a)
      .def(
          "push_own",
          [](PyBench& self, std::size_t joint, double torque) { self.require_own_arm().push(joint, torque); },
          "joint"_a, "torque_nm"_a)
      .def(
          "obstruct_own",
          [](PyBench& self, std::size_t joint, std::optional<double> angle) {
            self.require_own_arm().obstruct(joint, angle);
          },
          "joint"_a, "angle"_a.none())
      .def_prop_ro(
          "own_arm", [](PyBench& self) -> arm::Arm* { return self.own_arm() ? &self.own_arm()->arm() : nullptr; },
          nb::rv_policy::reference_internal, nb::sig("def own_arm(self) -> Arm | None"),
          "The bench's own arm; None where another engine moves it.")
      .def_prop_ro(
          "stops",
          [](PyBench& self) {
            constexpr double kFar = std::numeric_limits<double>::infinity();
            bench::Four low{-kFar, -kFar, -kFar, -kFar}, high{kFar, kFar, kFar, kFar};
            for (std::size_t joint = 0; self.own_arm() && joint < low.size(); ++joint) {
              low[joint] = self.own_arm()->stops()[joint].min;
              high[joint] = self.own_arm()->stops()[joint].max;
            }
            return std::tuple(array_of(low), array_of(high));
          },
          nb::rv_policy::move, "The lowest and highest angles of the follower, rad, where its plant says them.")
      .def_prop_ro(
          "tip_kg",
          [](PyBench& self) {
            return self.own_arm() ? std::optional<double>(self.own_arm()->tip_mass()) : std::nullopt;
          },
          "The mass that the arm carries; None for an arm that cannot be loaded.")
      .def(
          "place", [](PyBench& self, const In& pose) { self.place(Copy(pose).array()); }, "pose"_a,
          "Hold the follower in a pose by hand, if the plant allows that; no hand moves it beyond its stops.");
}

}  // namespace

void bind_bench(nb::module_& m) {
  m.attr("SLICE_CYCLES") = bench::kSliceCycles;
  m.attr("CLOCK_HZ") = bench::kClockHz;
  bind_person(m);
  bind_parts(m);
  BenchClass bench(m, "Bench", "Board, arm, potentiometers, wires and a person in lock step.");
  bench
      .def(nb::init<nb::handle, const bench::Wiring&, bench::Person&, nb::handle, const bench::Pots&, std::uint64_t,
                    const bench::Electrics&>(),
           "board"_a, "wiring"_a, "person"_a, "plant"_a, "pots"_a, "seed"_a, "electrics"_a,
           "`plant` is the parameters of the bench's own arm, or an object with step(voltages, dt). Who makes a bench "
           "keeps its parts alive.")
      .def("advance", &run, "count"_a, "trace"_a.none(),
           "False where the program on the board crashed. `trace(cycle, pins, angles)` is called after every slice.")
      .def_prop_ro(
          "angles", [](nb::handle self) { return view_of(nb::cast<PyBench&>(self).angles(), self); },
          nb::sig("def angles(self) -> numpy.typing.NDArray[numpy.float64]"))
      .def_prop_ro(
          "voltages", [](nb::handle self) { return view_of(nb::cast<PyBench&>(self).voltages(), self); },
          nb::sig("def voltages(self) -> numpy.typing.NDArray[numpy.float64]"))
      .def_prop_ro(
          "bridges", [](const PyBench& b) { return nb::list(nb::cast(b.bridges())); },
          nb::sig("def bridges(self) -> list[Bridge]"))
      .def(
          "take_pins_seen",
          [](PyBench& self, std::uint64_t cycle) {
            const bench::PinsSeen seen = self.take_pins_seen();
            return std::tuple(seen.duties(), seen.longest(cycle));
          },
          "cycle"_a,
          "The highest duty of each driver, and the most cycles that they were enabled without a break, since this was "
          "asked last.");
  bind_faults(bench);
  bind_arm_of(bench);
}
