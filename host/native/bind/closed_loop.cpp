// Binds the closed loop; greywhale.loop checks the arguments and explains them. Use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "arm/arm.h"
#include "arm/sensor.h"
#include "arrays.h"
#include "bindings.h"
#include "closed_loop/batch.h"
#include "closed_loop/block.h"
#include "closed_loop/controllers.h"
#include "closed_loop/experiment.h"
#include "closed_loop/plant_columns.h"
#include "closed_loop/plant_row.h"
#include "closed_loop/readings.h"
#include "closed_loop/swings.h"
#include "share_out.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace arm = greywhale::arm;
namespace loop = greywhale::loop;

namespace {

using greywhale::bind::Array;
using greywhale::bind::In;
using loop::kJoints;

template <class T>
using Each = std::array<T, kJoints>;

using ControllerTable = In<std::int32_t, nb::shape<-1, kJoints, loop::kControllerColumns>>;
using PlantTable = In<double, nb::shape<-1, loop::kPlantColumns>>;

// The experiment with the arrays that it looks into.
struct ClosedLoop {
  loop::Experiment x;
  In<std::int16_t, nb::shape<-1, kJoints>> reference;
  In<double, nb::shape<-1, kJoints>> leader;
  In<double, nb::shape<-1>> weight;
  std::vector<float> noise;
  std::string instructions;
};

template <class T, class U>
void copy(const Each<U>& from, T (&to)[kJoints]) {
  std::transform(from.begin(), from.end(), to, [](U value) { return static_cast<T>(value); });
}

loop::Calibration calibration_of(const Each<int>& zero, const Each<int>& scale) {
  loop::Calibration c{};
  copy(zero, c.zero);
  copy(scale, c.scale);
  return c;
}

// As greywhale.loop passes it on; checked there.
void make_settings(loop::Settings* self, int period_ms, int supply_mv, int soft_start_ms, int filter_shift,
                   const Each<int>& limit_min, const Each<int>& limit_max, const Each<int>& motor_sign,
                   const Each<int>& pwm_top, const Each<int>& leader_zero, const Each<int>& leader_scale,
                   const Each<int>& follower_zero, const Each<int>& follower_scale) {
  new (self) loop::Settings{};
  self->period_ms = period_ms;
  self->supply_mv = static_cast<std::uint16_t>(supply_mv);
  self->soft_start_ms = static_cast<std::uint16_t>(soft_start_ms);
  self->filter_shift = filter_shift;
  copy(limit_min, self->limit_min);
  copy(limit_max, self->limit_max);
  copy(motor_sign, self->motor_sign);
  copy(pwm_top, self->pwm_top);
  self->leader = calibration_of(leader_zero, leader_scale);
  self->follower = calibration_of(follower_zero, follower_scale);
}

void make_loop(ClosedLoop* self, const loop::Settings& settings, const loop::Timing& timing,
               const std::array<arm::Potentiometer, kJoints>& pots, double pot_supply, std::uint64_t seed,
               const Each<double>& home, const Each<double>& gap,
               const In<std::int16_t, nb::shape<-1, kJoints>>& reference,
               const In<double, nb::shape<-1, kJoints>>& leader, const In<double, nb::shape<-1>>& weight,
               const std::string& instructions) {
  if (reference.shape(0) != leader.shape(0) || weight.shape(0) != leader.shape(0)) {
    throw std::invalid_argument("reference, leader and weight differ in length.");
  }
  new (self) ClosedLoop{{}, reference, leader, weight, {}, instructions};
  loop::Experiment& x = self->x;
  x.settings = settings;
  x.timing = timing;
  x.pots = pots;
  x.pot_supply = pot_supply;
  x.seed = seed;
  copy(home, x.home);
  copy(gap, x.gap);
  x.ticks = reference.shape(0);
  x.reference = reference.data();
  x.leader = leader.data();
  x.weight = weight.data();
  self->noise = loop::noise_of(x, instructions);
  x.noise = self->noise.empty() ? nullptr : self->noise.data();
}

nb::tuple run(const ClosedLoop& self, const ControllerTable& controllers, const PlantTable& plants, int substeps,
              int threads, std::size_t every, bool exact) {
  const std::size_t count = std::max(controllers.shape(0), plants.shape(0));
  if (count == 0 || (controllers.shape(0) != count && controllers.shape(0) != 1) ||
      (plants.shape(0) != count && plants.shape(0) != 1)) {
    throw std::invalid_argument("controllers and plants must hold as many rows, or one of them a single row.");
  }
  const std::size_t rows = every == 0 ? 0 : (self.x.ticks + every - 1) / every;
  Array<double> mse({count, kJoints}), itae({count, kJoints}), itau({count, kJoints});
  Array<bool> diverged({count});
  Array<float> angles({count, rows, kJoints});
  Array<std::int16_t> duties({count, rows, kJoints});
  const std::vector<loop::Controllers> laws =
      loop::compiled(controllers.data(), controllers.shape(0), self.x.settings.period_ms);
  const auto* plant_rows = reinterpret_cast<const loop::PlantRow*>(plants.data());
  {
    const nb::gil_scoped_release free;
    const loop::Batch batch{laws.data(), laws.size(), plant_rows, plants.shape(0), count};
    const loop::Outputs outputs{mse.data(), itae.data(), itau.data(),   diverged.data(),
                                every,      rows,        angles.data(), duties.data()};
    loop::run_batch(self.x, batch, {substeps, threads, exact, self.instructions}, outputs);
  }
  return nb::make_tuple(mse.numpy(), itae.numpy(), itau.numpy(), diverged.numpy(), angles.numpy(), duties.numpy());
}

nb::tuple leader_readings(const loop::Settings& settings, const loop::Timing& timing,
                          const std::array<arm::Potentiometer, kJoints>& pots, double pot_supply, std::uint64_t seed,
                          const In<double, nb::shape<-1, kJoints>>& angles) {
  const std::size_t ticks = angles.shape(0) / loop::kSlices;
  Array<std::int16_t> reference({ticks, kJoints});
  Array<double> leader({ticks, kJoints});
  loop::read_leader(settings, timing, {pots, pot_supply, seed}, angles.data(), ticks, reference.data(), leader.data());
  return nb::make_tuple(reference.numpy(), leader.numpy());
}

// Times and plus of the four lines.
nb::object follower_lines(const loop::Settings& settings, const loop::Pots4& leader_pots, double leader_supply,
                          const loop::Pots4& follower_pots, double follower_supply) {
  Array<double> found({2, kJoints});
  const loop::Lines lines = loop::follower_lines(settings, leader_pots, leader_supply, follower_pots, follower_supply);
  for (std::size_t i = 0; i < kJoints; ++i) {
    found.data()[i] = lines[i].times;
    found.data()[kJoints + i] = lines[i].plus;
  }
  return found.numpy();
}

// The vector form of the law for sixteen controllers side by side; tests compare it with the firmware's own.
nb::object sixteen_laws(const In<std::int32_t, nb::shape<loop::kBlock, loop::kControllerColumns>>& controllers,
                        int period_ms, const In<std::int32_t, nb::shape<-1, loop::kBlock>>& leader,
                        const In<std::int32_t, nb::shape<-1, loop::kBlock>>& follower,
                        const In<std::uint16_t, nb::shape<-1>>& limit_mv, const std::string& instructions) {
  const std::size_t n = leader.shape(0);
  if (follower.shape(0) != n || limit_mv.shape(0) != n)
    throw std::invalid_argument("leader, follower and limit_mv differ in length.");
  std::array<fuzzy_pdi::Coefficients, loop::kBlock> laws;
  for (std::size_t lane = 0; lane < loop::kBlock; ++lane) {
    if (loop::compile(&controllers(lane, 0), period_ms, laws[lane]) != fuzzy_pdi::Refusal::none) {
      throw std::invalid_argument("controllers[" + std::to_string(lane) + "] is refused by the firmware.");
    }
  }
  Array<std::int32_t> millivolts({n, loop::kBlock});
  loop::check_law(instructions, {laws.data(), n, leader.data(), follower.data(), limit_mv.data(), millivolts.data()});
  return millivolts.numpy();
}

// Reversals and travel (n x 4) of traces (n x rows x 4) between two rows.
template <class T>
nb::tuple swings(const In<T, nb::shape<-1, -1, kJoints>>& traces, std::size_t first, std::size_t last, double band) {
  if (first > last || last > traces.shape(1))
    throw std::invalid_argument("the rows must lie within the traces, the first before the last.");
  const std::size_t count = traces.shape(0);
  Array<std::int32_t> reversals({count, kJoints});
  Array<double> travel({count, kJoints});
  {
    const nb::gil_scoped_release free;
    greywhale::share_out(count, 0, [&](std::size_t n) {
      loop::Swings found[kJoints];
      loop::swings_of<kJoints>(traces.data() + (n * traces.shape(1) + first) * kJoints, last - first, band, found);
      for (std::size_t i = 0; i < kJoints; ++i) {
        reversals.data()[n * kJoints + i] = found[i].reversals;
        travel.data()[n * kJoints + i] = found[i].travel;
      }
    });
  }
  return nb::make_tuple(reversals.numpy(), travel.numpy());
}

// What each plant's potentiometers show of traces of its angles.
nb::object shown_angles(const In<float, nb::shape<-1, -1, kJoints>>& angles, const PlantTable& plants, double row_s) {
  const std::size_t count = angles.shape(0), rows = angles.shape(1);
  if (plants.shape(0) != count) throw std::invalid_argument("angles and plants differ in number.");
  Array<double> shown({count, rows, kJoints});
  for (std::size_t n = 0; n < count; ++n) {
    const auto& row = *reinterpret_cast<const loop::PlantRow*>(plants.data() + n * loop::kPlantColumns);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const arm::Sensor<double>& sensor = row.plant.joints[i].sensor;
      const arm::Lag<double> lag = arm::lag_of(sensor.lag, row_s);
      arm::Shown<double> now{};
      for (std::size_t k = 0; k < rows; ++k) {
        const std::size_t at = (n * rows + k) * kJoints + i;
        const double angle = static_cast<double>(angles.data()[at]);
        if (k == 0) now = {angle, angle};
        arm::follow(sensor, lag, angle, now);
        shown.data()[at] = now.after;
      }
    }
  }
  return shown.numpy();
}

nb::object plant_row(const arm::ArmParameters& parameters) {
  Array<double> row({loop::kPlantColumns});
  const loop::PlantRow one = loop::plant_row(parameters);
  std::copy_n(reinterpret_cast<const double*>(&one), loop::kPlantColumns, row.data());
  return row.numpy();
}

}  // namespace

void bind_closed_loop(nb::module_& m) {
  nb::class_<loop::Settings>(m, "LoopSettings", "The values of a parameter table that the closed loop needs, raw.")
      .def("__init__", &make_settings, nb::kw_only(), "period_ms"_a, "supply_mv"_a, "soft_start_ms"_a, "filter_shift"_a,
           "limit_min"_a, "limit_max"_a, "motor_sign"_a, "pwm_top"_a, "leader_zero"_a, "leader_scale"_a,
           "follower_zero"_a, "follower_scale"_a);
  nb::class_<loop::Timing>(
      m, "LoopTiming",
      "Within a tick: the start of conversions (cycles), of voltages (slices); and the lateness of duties (ticks).")
      .def(
          "__init__",
          [](loop::Timing* self, int start, const Each<int>& acts, int on, int late) {
            new (self) loop::Timing{start, {}, on, late};
            copy(acts, self->acts);
          },
          nb::kw_only(), "start"_a, "acts"_a, "on"_a, "late"_a = 0);
  nb::class_<ClosedLoop>(m, "ClosedLoop", "One experiment, for any number of candidates.")
      .def("__init__", &make_loop, nb::kw_only(), "settings"_a, "timing"_a, "pots"_a, "pot_supply"_a, "seed"_a,
           "home"_a, "gap"_a, "reference"_a.noconvert(), "leader"_a.noconvert(), "weight"_a.noconvert(),
           "instructions"_a)
      .def("run", &run, nb::kw_only(), "controllers"_a.noconvert(), "plants"_a.noconvert(), "substeps"_a, "threads"_a,
           "every"_a, "exact"_a,
           "mse, itae, itau (n x 4), diverged (n), angles (float32) and duties (int16), both n x rows x 4. The GIL is "
           "released.");
  m.def("leader_readings", &leader_readings, nb::kw_only(), "settings"_a, "timing"_a, "pots"_a, "pot_supply"_a,
        "seed"_a, "angles"_a.noconvert(),
        "The leader's angles in every slice to q12 readings and true angles at every tick.");
  m.def("follower_lines", &follower_lines, nb::kw_only(), "settings"_a, "leader_pots"_a, "leader_supply"_a,
        "follower_pots"_a, "follower_supply"_a,
        "Times and plus (2 x 4), rad: the follower's angle that reads as times x the leader's angle + plus does.");
  m.def("sixteen_laws", &sixteen_laws, nb::kw_only(), "controllers"_a.noconvert(), "period_ms"_a,
        "leader"_a.noconvert(), "follower"_a.noconvert(), "limit_mv"_a.noconvert(), "instructions"_a,
        "The batch kernel's form of the law, in mV; for tests.");
  m.def("swings", &swings<float>, "traces"_a.noconvert(), "first"_a, "last"_a, "band"_a,
        "Number (int32) and travel (float64) of the swings of traces, n x rows x 4, by more than the band: both n "
        "x 4.");
  m.def("swings", &swings<std::int16_t>, "traces"_a.noconvert(), "first"_a, "last"_a, "band"_a);
  m.def("shown_angles", &shown_angles, nb::kw_only(), "angles"_a.noconvert(), "plants"_a.noconvert(), "row_s"_a,
        "Readings (float64) of the plants' potentiometers for joint angles, n x rows x 4, a row every row_s.");
  m.def("plant_row", &plant_row, "parameters"_a, "An arm as one row of numbers.");
  m.def("instruction_sets", &loop::instruction_sets,
        "Those of the batch kernel that this processor runs, the best first.");
  m.attr("PLANT_COLUMNS") = loop::kPlantColumns;
  m.attr("PLANT_COLUMN_NAMES") = nb::tuple(nb::cast(loop::plant_column_names()));
}
