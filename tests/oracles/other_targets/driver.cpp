// Repeats calls of greywhale._native on another target: driver CALLS RESULTS. See tests/oracles/native_calls.py for
// the file's form.
//
// Every call is its name and its arguments in the order of the functions here: whole numbers as int64, others as
// float64, arrays as their number of elements and the elements. The results are the elements of the arrays that the
// call returns, one after the other.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "closed_loop/batch.h"
#include "closed_loop/block.h"
#include "closed_loop/controllers.h"
#include "closed_loop/experiment.h"
#include "ideal/simulate.h"
#include "windows/windows.h"

namespace {

namespace arm = greywhale::arm;
namespace ideal = greywhale::ideal;
namespace loop = greywhale::loop;
namespace windows = greywhale::windows;
using arm::kJoints;

class Calls {
 public:
  explicit Calls(const char* path) : file_(path, std::ios::binary) {
    if (!file_) throw std::runtime_error(std::string(path) + " cannot be read.");
  }
  bool more() { return file_.peek() != std::ifstream::traits_type::eof(); }

  template <class T>
  T take() {
    T value;
    read(&value, sizeof value);
    return value;
  }
  std::int64_t whole() { return take<std::int64_t>(); }
  std::size_t size() { return static_cast<std::size_t>(whole()); }
  int number() { return static_cast<int>(whole()); }
  double real() { return take<double>(); }

  template <class T>
  std::vector<T> array() {
    std::vector<T> values(size());
    read(values.data(), values.size() * sizeof(T));
    return values;
  }
  template <class T>
  void four(T (&to)[kJoints]) {
    for (T& value : to) value = static_cast<T>(whole());
  }
  void four(double (&to)[kJoints]) {
    for (double& value : to) value = real();
  }

 private:
  void read(void* to, std::size_t bytes) {
    if (!file_.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)))
      throw std::runtime_error("the calls end too early.");
  }
  std::ifstream file_;
};

class Results {
 public:
  explicit Results(const char* path) : file_(path, std::ios::binary) {}
  template <class T>
  void give(const T* values, std::size_t count) {
    file_.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
  }
  template <class T>
  void give(const std::vector<T>& values) {
    give(values.data(), values.size());
  }

 private:
  std::ofstream file_;
};

loop::Settings take_settings(Calls& calls) {
  loop::Settings s{};
  s.period_ms = calls.number();
  s.supply_mv = static_cast<std::uint16_t>(calls.whole());
  s.soft_start_ms = static_cast<std::uint16_t>(calls.whole());
  s.filter_shift = calls.number();
  calls.four(s.limit_min);
  calls.four(s.limit_max);
  calls.four(s.motor_sign);
  calls.four(s.pwm_top);
  calls.four(s.leader.zero);
  calls.four(s.leader.scale);
  calls.four(s.follower.zero);
  calls.four(s.follower.scale);
  return s;
}

loop::Timing take_timing(Calls& calls) {
  loop::Timing t{};
  t.start = calls.number();
  calls.four(t.acts);
  t.on = calls.number();
  t.late = calls.number();
  return t;
}

std::array<arm::Potentiometer, kJoints> take_pots(Calls& calls) {
  std::array<arm::Potentiometer, kJoints> pots{};
  for (arm::Potentiometer& pot : pots) {
    pot.track = calls.real();
    pot.centre = calls.real();
    pot.direction = calls.real();
    pot.noise = calls.real();
    pot.linearity = calls.real();
    pot.sensor.play = calls.real();
    pot.sensor.lag = calls.real();
  }
  return pots;
}

void leader_readings(Calls& calls, Results& results) {
  const loop::Settings settings = take_settings(calls);
  const loop::Timing timing = take_timing(calls);
  const std::array<arm::Potentiometer, kJoints> pots = take_pots(calls);
  const double supply = calls.real();
  const std::uint64_t seed = static_cast<std::uint64_t>(calls.whole());
  const std::vector<double> angles = calls.array<double>();
  const std::size_t ticks = angles.size() / kJoints / loop::kSlices;
  std::vector<std::int16_t> reference(ticks * kJoints);
  std::vector<double> leader(ticks * kJoints);
  loop::read_leader(settings, timing, {pots, supply, seed}, angles.data(), ticks, reference.data(), leader.data());
  results.give(reference);
  results.give(leader);
}

void run(Calls& calls, Results& results) {
  loop::Experiment x{};
  x.settings = take_settings(calls);
  x.timing = take_timing(calls);
  x.pots = take_pots(calls);
  x.pot_supply = calls.real();
  x.seed = static_cast<std::uint64_t>(calls.whole());
  calls.four(x.home);
  calls.four(x.gap);
  const std::vector<std::int16_t> reference = calls.array<std::int16_t>();
  const std::vector<double> leader = calls.array<double>(), weight = calls.array<double>();
  x.ticks = weight.size();
  x.reference = reference.data();
  x.leader = leader.data();
  x.weight = weight.data();
  const std::vector<float> noise = loop::noise_of(x, "");
  x.noise = noise.empty() ? nullptr : noise.data();

  const std::vector<std::int32_t> table = calls.array<std::int32_t>();
  const std::size_t controller_count = table.size() / kJoints / loop::kControllerColumns;
  const std::vector<loop::Controllers> laws = loop::compiled(table.data(), controller_count, x.settings.period_ms);
  const std::vector<double> plants = calls.array<double>();
  const std::size_t plant_count = plants.size() / loop::kPlantColumns, count = std::max(controller_count, plant_count);
  const int substeps = calls.number();
  const std::size_t every = calls.size();
  const bool exact = calls.whole() != 0;

  const std::size_t rows = every == 0 ? 0 : (x.ticks + every - 1) / every;
  std::vector<double> mse(count * kJoints), itae(mse), itau(mse);
  const std::unique_ptr<bool[]> diverged = std::make_unique<bool[]>(count);
  std::vector<float> angles(count * rows * kJoints);
  std::vector<std::int16_t> duties(angles.size());
  const auto* plant_rows = reinterpret_cast<const loop::PlantRow*>(plants.data());
  loop::run_batch(x, {laws.data(), laws.size(), plant_rows, plant_count, count}, {substeps, 0, exact, ""},
                  {mse.data(), itae.data(), itau.data(), diverged.get(), every, rows, angles.data(), duties.data()});
  results.give(mse);
  results.give(itae);
  results.give(itau);
  results.give(diverged.get(), count);
  results.give(angles);
  results.give(duties);
}

void sixteen_laws(Calls& calls, Results& results) {
  const std::vector<std::int32_t> table = calls.array<std::int32_t>();
  const int period_ms = calls.number();
  std::array<fuzzy_pdi::Coefficients, loop::kBlock> laws;
  for (std::size_t lane = 0; lane < loop::kBlock; ++lane) {
    if (loop::compile(&table[lane * loop::kControllerColumns], period_ms, laws[lane]) != fuzzy_pdi::Refusal::none) {
      throw std::runtime_error("a controller is refused.");
    }
  }
  const std::vector<std::int32_t> leader = calls.array<std::int32_t>(), follower = calls.array<std::int32_t>();
  const std::vector<std::uint16_t> limit = calls.array<std::uint16_t>();
  std::vector<std::int32_t> millivolts(leader.size());
  loop::check_law("", {laws.data(), limit.size(), leader.data(), follower.data(), limit.data(), millivolts.data()});
  results.give(millivolts);
}

void simulate_windows(Calls& calls, Results& results) {
  const std::vector<double> plants = calls.array<double>(), offsets = calls.array<double>();
  const std::vector<std::int64_t> first = calls.array<std::int64_t>();
  const std::vector<double> angles = calls.array<double>(), velocities = calls.array<double>(),
                            sides = calls.array<double>(), places = calls.array<double>();
  const std::size_t rows = calls.size();
  const std::vector<double> volts = calls.array<double>(), spacing = calls.array<double>();
  const std::size_t substeps = calls.size(), every = calls.size();
  const std::size_t candidates = plants.size() / loop::kPlantColumns, size = (rows + every - 1) / every * kJoints;
  std::vector<double> values(candidates * first.size() * size);
  std::vector<windows::Task> tasks;
  for (std::size_t window = 0; window < first.size(); ++window) {
    for (std::size_t n = 0; n < candidates; ++n) {
      tasks.push_back({&plants[n * loop::kPlantColumns], &offsets[n * kJoints], window,
                       &values[(n * first.size() + window) * size]});
    }
  }
  windows::simulate({first.data(), angles.data(), velocities.data(), sides.data(), places.data(), volts.data(),
                     spacing.data(), rows, substeps, every},
                    tasks, 0);
  results.give(values);
}

void simulate_ideal(Calls& calls, Results& results) {
  const std::vector<double> leader = calls.array<double>();
  const std::size_t slices = leader.size() / kJoints, late = calls.size();
  const std::vector<double> plant = calls.array<double>();
  const double supply = calls.real();
  const std::vector<double> numbers = calls.array<double>();
  const int chased = calls.number();
  const std::vector<std::int8_t> direction = calls.array<std::int8_t>();
  const std::vector<double> until = calls.array<double>();
  std::vector<ideal::Tuning> tunings(numbers.size() * sizeof(double) / sizeof(ideal::Tuning));
  std::memcpy(tunings.data(), numbers.data(), numbers.size() * sizeof(double));
  const std::size_t count = tunings.size() / kJoints;
  std::vector<double> mse(count * kJoints), angles(count * slices / loop::kSlices * kJoints);
  const ideal::Chase chase{chased < 0 ? kJoints : static_cast<std::size_t>(chased), direction.data(), until.data()};
  ideal::simulate({leader.data(), slices, late, plant.data(), supply, chase}, tunings.data(), count, 0, mse.data(),
                  angles.data());
  results.give(mse);
  results.give(angles);
}

const std::map<std::string, void (*)(Calls&, Results&)> kCalls = {
    {"leader_readings", leader_readings}, {"run", run},
    {"sixteen_laws", sixteen_laws},       {"simulate_windows", simulate_windows},
    {"simulate_ideal", simulate_ideal},
};

}  // namespace

int main(int, char** arguments) {
  try {
    Calls calls(arguments[1]);
    Results results(arguments[2]);
    while (calls.more()) {
      const std::vector<char> name = calls.array<char>();
      kCalls.at({name.begin(), name.end()})(calls, results);
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
