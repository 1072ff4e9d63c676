// What the tuner in a page calls: the closed loop of many candidates, and what a search wants to know of them. Numbers
// go in and out through two buffers; a caller keeps to the orders that are said here, for nothing is checked twice.
#include <algorithm>
#include <memory>
#include <utility>

#include "arm/elementary.h"
#include "closed_loop/readings.h"
#include "experiments.h"

namespace greywhale::web {

std::vector<double> given, found;

namespace {

constexpr int kStepsPerTick = 2, kStepsPerSlice = 1;  // as greywhale.loop has them

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

}  // namespace

Kept& experiment_of(unsigned number) { return *experiments.at(number); }

std::vector<std::int32_t> given_table() { return {given.begin(), given.end()}; }

void run(Kept& kept, const std::vector<std::int32_t>& table, bool exact) {
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
                  {exact ? kStepsPerSlice : kStepsPerTick, 1, exact, ""},
                  {kept.mse.data(), kept.itae.data(), kept.itau.data(), kept.diverged.get(), 1, kept.x.ticks,
                   kept.angles.data(), kept.duties.data()});
}

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
  kept->reference.resize(x.ticks * kJoints);
  kept->leader.resize(x.ticks * kJoints);
  const std::vector<double> slices = slices_of(rows, apart, wait, x.ticks * loop::kSlices);
  loop::read_leader(x.settings, x.timing, {leader_pots, leader_supply, leader_seed}, slices.data(), x.ticks,
                    kept->reference.data(), kept->leader.data());
  const loop::Lines lines = loop::follower_lines(x.settings, leader_pots, leader_supply, x.pots, x.pot_supply);
  for (std::size_t n = 0; n < kept->leader.size(); ++n)
    kept->leader[n] = lines[n % kJoints].times * kept->leader[n] + lines[n % kJoints].plus;
  std::copy_n(kept->leader.begin(), kJoints, x.home);
  x.reference = kept->reference.data();
  x.leader = kept->leader.data();
  x.weight = kept->weight.data();
  kept->noise = loop::noise_of(x, "");
  x.noise = kept->noise.empty() ? nullptr : kept->noise.data();
  experiments.push_back(std::move(kept));
  return static_cast<unsigned>(experiments.size() - 1);
}

// Given: the rows of the candidates' controllers.
EXPORT(run) void exported_run(unsigned experiment, unsigned exact) {
  run(experiment_of(experiment), given_table(), exact != 0);
}

// Of the last run, of each row and joint.
EXPORT(mse) void exported_mse(unsigned experiment) { found = experiment_of(experiment).mse; }

// The leader's angles and those of a row of the last run: ticks x 4 each, of which every `every`-th tick.
EXPORT(trace) unsigned exported_trace(unsigned experiment, unsigned row, unsigned every) {
  const Kept& kept = experiment_of(experiment);
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
