// What the tuner in a page calls: the closed loop of many candidates, and what a search wants to know of them. Numbers
// go in and out through two buffers; a caller keeps to the orders that are said here, for nothing is checked twice.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "arm/elementary.h"
#include "closed_loop/band_power.h"
#include "closed_loop/batch.h"
#include "closed_loop/controllers.h"
#include "closed_loop/experiment.h"
#include "closed_loop/swings.h"

#define EXPORT(name) __attribute__((export_name(#name)))

namespace greywhale::web {
namespace {

using loop::kJoints;

constexpr int kStepsPerTick = 2, kStepsPerSlice = 1;  // as greywhale.loop has them

std::vector<double> given, found;

// Reads what is given, in order.
class Reader {
 public:
  double next() { return given.at(at_++); }
  std::size_t size() { return static_cast<std::size_t>(next()); }
  std::size_t left() const { return given.size() - at_; }
  template <class T>
  void four(T (&to)[kJoints]) {
    for (T& value : to) value = static_cast<T>(next());
  }
  std::vector<double> some(std::size_t count) {
    at_ += count;
    return {given.end() - static_cast<std::ptrdiff_t>(left() + count),
            given.end() - static_cast<std::ptrdiff_t>(left())};
  }

  loop::Settings settings() {
    loop::Settings s{};
    s.period_ms = static_cast<int>(next());
    s.supply_mv = static_cast<std::uint16_t>(next());
    s.soft_start_ms = static_cast<std::uint16_t>(next());
    s.filter_shift = static_cast<int>(next());
    four(s.limit_min), four(s.limit_max), four(s.motor_sign), four(s.pwm_top);
    four(s.leader.zero), four(s.leader.scale), four(s.follower.zero), four(s.follower.scale);
    return s;
  }

  loop::Timing timing() {
    loop::Timing t{};
    t.start = static_cast<int>(next());
    four(t.acts);
    t.on = static_cast<int>(next());
    t.late = static_cast<int>(next());
    return t;
  }

  std::array<arm::Potentiometer, kJoints> pots() {
    std::array<arm::Potentiometer, kJoints> pots{};
    for (arm::Potentiometer& pot : pots) pot = {next(), next(), next(), next(), next(), {next(), next()}};
    return pots;
  }

 private:
  std::size_t at_ = 0;
};

// An experiment on some plants, and what the last candidates did there: each on every plant, one plant after the other.
struct Kept {
  loop::Experiment x{};
  std::vector<loop::PlantRow> plants;
  std::vector<std::int16_t> reference;
  std::vector<double> leader, weight;
  std::vector<float> noise;
  std::size_t count = 0;  // candidates times plants
  std::vector<double> mse, itae, itau;
  std::unique_ptr<bool[]> diverged;
  std::vector<float> angles;
  std::vector<std::int16_t> duties;
};
std::vector<std::unique_ptr<Kept>> experiments;

// Straight lines between rows that are `apart` slices from each other, after a wait in the first row.
std::vector<double> slices_of(const std::vector<double>& rows, std::size_t apart, std::size_t wait,
                              std::size_t slices) {
  std::vector<double> angles(slices * kJoints);
  const std::size_t last = rows.size() / kJoints - 1;
  for (std::size_t slice = 0; slice < slices; ++slice) {
    const std::size_t at = slice < wait ? 0 : slice - wait, row = std::min(at / apart, last - 1);
    const double share = std::min(static_cast<double>(at - row * apart) / static_cast<double>(apart), 1.0);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double from = rows[row * kJoints + i], to = rows[(row + 1) * kJoints + i];
      angles[slice * kJoints + i] = from + share * (to - from);
    }
  }
  return angles;
}

// The highest power that the leader had in this block or in the `back` before it; before the first, as mirrored there.
double allowed(const std::vector<double>& led, std::size_t block, std::size_t back, std::size_t joint) {
  double most = led[block * kJoints + joint];
  for (std::size_t n = 1; n <= back; ++n) {
    const std::size_t at = n <= block ? block - n : n - block - 1;
    most = std::max(most, led[at * kJoints + joint]);
  }
  return most;
}

template <class T>
std::vector<double> power(const T* angles, std::size_t ticks, const std::vector<double>& s, std::size_t every,
                          std::size_t length) {
  const std::size_t blocks = (ticks + every - 1) / every / length;
  std::vector<double> power(blocks * kJoints);
  loop::band_power<kJoints>(angles, every, blocks, length, {s[0], s[1], s[2], s[4], s[5]},
                            {s[6], s[7], s[8], s[10], s[11]}, power.data());
  return power;
}

// Turns of the duties of a row's joints by more than a share of the largest.
std::array<std::int32_t, kJoints> duty_swings(const Kept& kept, std::size_t n, std::size_t first, std::size_t last,
                                              double share) {
  const auto& top = kept.x.settings.pwm_top;
  std::array<std::int32_t, kJoints> turns{};
  loop::Swings swings[kJoints];
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (i == 0 || top[i] != top[i - 1])
      loop::swings_of<kJoints>(&kept.duties[(n * kept.x.ticks + first) * kJoints], last - first, share * top[i],
                               swings);
    turns[i] = swings[i].reversals;
  }
  return turns;
}

}  // namespace

extern "C" {

EXPORT(exponential) double exported_exponential(double x) { return arm::exponential(x); }
EXPORT(logarithm) double exported_logarithm(double x) { return arm::logarithm(x); }
EXPORT(cosine) double exported_cosine(double x) { return arm::cosine(x); }

// Where so many numbers are to be put, and where the numbers stand that a call has found.
EXPORT(give) double* exported_give(unsigned count) {
  given.resize(count);
  return given.data();
}
EXPORT(found) const double* exported_found() { return found.data(); }

// Given: settings; timing; the leader's pots, their supply and their noise's seed; the same of the follower; where each
// gear stands in its gap; the motion's wait and how far its rows lie apart, in slices; how many plants, and these; how
// many ticks, and their weights; the rows of the motion. Answers with the experiment's number.
EXPORT(add) unsigned exported_add() {
  Reader reader;
  auto kept = std::make_unique<Kept>();
  loop::Experiment& x = kept->x;
  x.settings = reader.settings();
  x.timing = reader.timing();
  const std::array<arm::Potentiometer, kJoints> leader_pots = reader.pots();
  const double leader_supply = reader.next();
  const auto leader_seed = static_cast<std::uint64_t>(reader.next());
  x.pots = reader.pots();
  x.pot_supply = reader.next();
  x.seed = static_cast<std::uint64_t>(reader.next());
  reader.four(x.gap);
  const std::size_t wait = reader.size(), apart = reader.size();
  kept->plants.resize(reader.size());
  for (loop::PlantRow& plant : kept->plants) {
    const std::vector<double> row = reader.some(loop::kPlantColumns);
    std::copy(row.begin(), row.end(), reinterpret_cast<double*>(&plant));
  }
  x.ticks = reader.size();
  kept->weight = reader.some(x.ticks);
  const std::vector<double> rows = reader.some(reader.left());
  std::copy_n(rows.begin(), kJoints, x.home);
  kept->reference.resize(x.ticks * kJoints);
  kept->leader.resize(x.ticks * kJoints);
  const std::vector<double> slices = slices_of(rows, apart, wait, x.ticks * loop::kSlices);
  loop::read_leader(x.settings, x.timing, {leader_pots, leader_supply, leader_seed}, slices.data(), x.ticks,
                    kept->reference.data(), kept->leader.data());
  x.reference = kept->reference.data();
  x.leader = kept->leader.data();
  x.weight = kept->weight.data();
  kept->noise = loop::noise_of(x, "");
  x.noise = kept->noise.empty() ? nullptr : kept->noise.data();
  experiments.push_back(std::move(kept));
  return static_cast<unsigned>(experiments.size() - 1);
}

// Given: the rows of the candidates' controllers, 4 x 13 each. `exact`: in double precision.
EXPORT(run) void exported_run(unsigned experiment, unsigned exact) {
  Kept& kept = *experiments.at(experiment);
  const std::vector<std::int32_t> table(given.begin(), given.end());
  const std::size_t candidates = table.size() / kJoints / loop::kControllerColumns, plants = kept.plants.size();
  const std::vector<loop::Controllers> each = loop::compiled(table.data(), candidates, kept.x.settings.period_ms);
  std::vector<loop::Controllers> laws;
  std::vector<loop::PlantRow> arms;
  for (const loop::Controllers& law : each) {
    laws.insert(laws.end(), plants, law);
    arms.insert(arms.end(), kept.plants.begin(), kept.plants.end());
  }
  kept.count = laws.size();
  for (std::vector<double>* measure : {&kept.mse, &kept.itae, &kept.itau}) measure->resize(kept.count * kJoints);
  kept.diverged = std::make_unique<bool[]>(kept.count);
  kept.angles.resize(kept.count * kept.x.ticks * kJoints);
  kept.duties.resize(kept.angles.size());
  loop::run_batch(kept.x, {laws.data(), kept.count, arms.data(), kept.count, kept.count},
                  {exact ? kStepsPerSlice : kStepsPerTick, 1, exact != 0, ""},
                  {kept.mse.data(), kept.itae.data(), kept.itau.data(), kept.diverged.get(), 1, kept.x.ticks,
                   kept.angles.data(), kept.duties.data()});
}

// Of the last run, of each row and joint: mse, itae, itau, rattle, duty swings, whether it diverged. Given are: two
// sections of six numbers; ticks between what is filtered; length, look back and wait in blocks; the share of the duty
// that is a swing.
EXPORT(following) void exported_following(unsigned experiment) {
  const Kept& kept = *experiments.at(experiment);
  Reader reader;
  const std::vector<double> sections = reader.some(12);
  const std::size_t every = reader.size(), length = reader.size(), back = reader.size(), wait = reader.size();
  const double share = reader.next();
  const std::size_t ticks = kept.x.ticks;
  const std::vector<double> led = power(kept.x.leader, ticks, sections, every, length);
  const std::size_t blocks = led.size() / kJoints;
  found.clear();
  for (std::size_t n = 0; n < kept.count; ++n) {
    const std::vector<double> followed = power(&kept.angles[n * ticks * kJoints], ticks, sections, every, length);
    const std::array<std::int32_t, kJoints> turns = duty_swings(kept, n, 0, ticks, share);
    for (std::size_t i = 0; i < kJoints; ++i) {
      double excess = 0.0;
      for (std::size_t block = wait; block < blocks; ++block)
        excess += std::max(followed[block * kJoints + i] - allowed(led, block, back, i), 0.0);
      const std::size_t at = n * kJoints + i;
      const double rattle = std::sqrt(excess / static_cast<double>(blocks - wait));
      found.insert(found.end(), {kept.mse[at], kept.itae[at], kept.itau[at], rattle, static_cast<double>(turns[i]),
                                 kept.diverged[n] ? 1.0 : 0.0});
    }
  }
}

// Of the last run between two ticks, of each row and joint: turns of the angle by more than a band (rad) and the way
// between them, duty swings by more than a share, the duty's mean square less its own mean over a window of ticks,
// whether it diverged.
EXPORT(resting)
void exported_resting(unsigned experiment, unsigned first, unsigned last, double band, double share, unsigned window) {
  const Kept& kept = *experiments.at(experiment);
  found.clear();
  for (std::size_t n = 0; n < kept.count; ++n) {
    const std::size_t from = (n * kept.x.ticks + first) * kJoints;
    const std::array<std::int32_t, kJoints> turns = duty_swings(kept, n, first, last, share);
    loop::Swings swings[kJoints];
    loop::swings_of<kJoints>(&kept.angles[from], last - first, band, swings);
    for (std::size_t i = 0; i < kJoints; ++i)
      found.insert(
          found.end(),
          {static_cast<double>(swings[i].reversals), swings[i].travel, static_cast<double>(turns[i]),
           loop::ripple_of(&kept.duties[from + i], last - first, kJoints, window), kept.diverged[n] ? 1.0 : 0.0});
  }
}

// The leader's angles and those of a row of the last run: ticks x 4 each, of which every `every`-th tick.
EXPORT(trace) unsigned exported_trace(unsigned experiment, unsigned row, unsigned every) {
  const Kept& kept = *experiments.at(experiment);
  found.clear();
  for (std::size_t tick = 0; tick < kept.x.ticks; tick += every)
    found.insert(found.end(), &kept.x.leader[tick * kJoints], &kept.x.leader[tick * kJoints] + kJoints);
  const auto count = static_cast<unsigned>(found.size());
  const float* angles = &kept.angles[row * kept.x.ticks * kJoints];
  for (std::size_t tick = 0; tick < kept.x.ticks; tick += every)
    found.insert(found.end(), angles + tick * kJoints, angles + tick * kJoints + kJoints);
  return count;
}

}  // extern "C"

}  // namespace greywhale::web
