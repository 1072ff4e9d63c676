// What candidates cost a search in a page, and who falls short of what held before.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "experiments.h"
#include "score/following.h"
#include "score/unrest.h"

namespace greywhale::web {
namespace {

// Plain numbers, in the order in which they are given.
struct Limits {
  score::SwingMeasure measure;
  score::CostLimits cost;
  score::SwingBounds swings;
  score::MarginLimits margins;
  score::ChoiceLimits choice;
  double supply_v;
};
constexpr std::size_t kLimits = sizeof(Limits) / sizeof(double);

// A class of motion, on one plant.
struct Drill {
  unsigned experiment;
  score::Rattle rattle;
  double total_weight;
  std::array<score::Scale, kJoints> scale;
};

// Rests on the plants of some scenarios, and on one where every duty acts later.
struct Stops {
  unsigned prompt, late;
  score::Rests rests;
};

// The controllers from before, the ripple that each joint may have, and in which scenarios each may fail.
struct Before {
  std::vector<std::int32_t> table;
  std::array<double, kJoints> quiet_v;
  std::vector<double> may_fail;
};

Limits limits;
std::vector<Drill> drills;
std::vector<double> importances;
std::vector<Stops> stops;
Before before;

score::Run outcome_of(const Kept& kept) {
  score::Run run{kept.count,         kept.x.ticks,       kept.mse.data(),
                 kept.itae.data(),   kept.itau.data(),   kept.diverged.get(),
                 kept.angles.data(), kept.duties.data(), {}};
  std::copy_n(kept.x.settings.pwm_top, kJoints, run.pwm_top.begin());
  return run;
}

std::vector<score::Errors> follow(const Drill& drill, const std::vector<std::int32_t>& table) {
  Kept& kept = experiment_of(drill.experiment);
  run(kept, table, false);
  return score::follow(outcome_of(kept), drill.rattle, drill.total_weight, limits.measure, limits.cost);
}

// The unrest of candidates in all scenarios, and what looks into it.
struct Unrests {
  std::vector<score::Unrest> unrest;
  score::Looked looked;
};

Unrests unrests_of(const Stops& at, const std::vector<std::int32_t>& table, bool exact) {
  constexpr std::size_t kPrompt = 4;  // scenarios before the last, which is late
  Kept &prompt = experiment_of(at.prompt), &late = experiment_of(at.late);
  run(prompt, table, exact);
  run(late, table, exact);
  const auto found = score::unrest_of(outcome_of(prompt), at.rests, limits.supply_v, limits.swings, limits.measure);
  const auto delayed = score::unrest_of(outcome_of(late), at.rests, limits.supply_v, limits.swings, limits.measure);
  Unrests all;
  for (std::size_t scenario = 0; scenario < kPrompt; ++scenario) {
    for (std::size_t n = 0; n < late.count; ++n) {
      const auto from = found.begin() + static_cast<std::ptrdiff_t>((n * kPrompt + scenario) * kJoints);
      all.unrest.insert(all.unrest.end(), from, from + kJoints);
    }
  }
  all.unrest.insert(all.unrest.end(), delayed.begin(), delayed.end());
  using score::Scenario;
  all.looked = {{Scenario::rest, Scenario::half_gain, Scenario::twice_gain, Scenario::soft_teeth, Scenario::delay},
                late.count,
                1,
                all.unrest.data()};
  return all;
}

}  // namespace

extern "C" {

// Begins anew. Given: all limits. Answers how many they are.
EXPORT(limit) unsigned exported_limit() {
  drills.clear(), importances.clear(), stops.clear();
  if (given.size() == kLimits) std::copy(given.begin(), given.end(), reinterpret_cast<double*>(&limits));
  return kLimits;
}

// Adds a class of motion. Given: its importance, the integral of its weights, the first block of rattle, and the floor
// of each joint.
EXPORT(drill) void exported_drill(unsigned experiment) {
  const Kept& kept = experiment_of(experiment);
  Reader reader;
  importances.push_back(reader.next());
  const double total_weight = reader.next();
  const std::size_t first_block = reader.size();
  drills.push_back({experiment, {kept.leader.data(), kept.x.ticks, first_block, limits.measure}, total_weight, {}});
  for (score::Scale& scale : drills.back().scale) scale.floor = reader.next();
}

// Adds the rests of two experiments. Given: the band and the turns of a limit cycle, and the ticks of each rest.
// Answers with their number.
EXPORT(stops) unsigned exported_stops(unsigned prompt, unsigned late) {
  Reader reader;
  const double band_rad = reader.next(), turns = reader.next();
  stops.push_back({prompt, late, {{}, band_rad, turns}});
  while (reader.left()) {
    const std::size_t first = reader.size(), last = reader.size();
    stops.back().rests.ticks.push_back({first, last});
  }
  return static_cast<unsigned>(stops.size() - 1);
}

// Given: the controllers from before, by which all others are judged, in these rests.
EXPORT(begin) void exported_begin(unsigned judging) {
  before.table = given_table();
  for (Drill& drill : drills) {
    const std::vector<score::Errors> found = follow(drill, before.table);
    for (std::size_t i = 0; i < kJoints; ++i) {
      score::Scale& scale = drill.scale[i];
      scale = {scale.floor, score::room_of(found[i].error, scale.floor, limits.cost), found[i].rattle};
    }
  }
  const Unrests all = unrests_of(stops.at(judging), before.table, true);
  before.may_fail = score::failing_in(all.looked);
  for (std::size_t i = 0; i < kJoints; ++i)
    before.quiet_v[i] = score::quiet_ripple(all.looked.at(0, 0, 0, i).ripple, limits.supply_v, limits.swings);
}

// Of each candidate that is given, of each joint.
EXPORT(costs) void exported_costs(unsigned searching) {
  const std::vector<std::int32_t> table = given_table();
  const std::size_t count = table.size() / kJoints / loop::kControllerColumns, each = drills.size() * kJoints;
  std::vector<double> relative(count * each);
  for (std::size_t c = 0; c < drills.size(); ++c) {
    const std::vector<score::Errors> followed = follow(drills[c], table);
    for (std::size_t at = 0; at < followed.size(); ++at)
      relative[at / kJoints * each + c * kJoints + at % kJoints] = score::relative_cost(
          followed[at], drills[c].scale[at % kJoints], limits.supply_v, limits.cost, limits.swings);
  }
  const Unrests all = unrests_of(stops.at(searching), table, false);
  found = score::unrest_prices(all.looked, before.quiet_v, limits.margins);
  for (std::size_t n = 0; n < count; ++n) {
    const auto totals = score::total_costs(&relative[n * each], 1, importances, limits.cost);
    for (std::size_t i = 0; i < kJoints; ++i) found[n * kJoints + i] += totals[i];
  }
}

// Of each joint of the controllers that are given: 1 where it falls short of what held before.
EXPORT(short) void exported_short(unsigned judging) {
  const std::vector<std::int32_t> table = given_table();
  std::array<bool, kJoints> kept;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto from = static_cast<std::ptrdiff_t>(i * loop::kControllerColumns);
    kept[i] =
        std::equal(table.begin() + from, table.begin() + from + loop::kControllerColumns, before.table.begin() + from);
  }
  const Unrests all = unrests_of(stops.at(judging), table, true);
  const std::vector<double> failing = score::failing_in(all.looked);
  std::array<double, kJoints> ripple_v;
  for (std::size_t i = 0; i < kJoints; ++i) ripple_v[i] = all.looked.at(0, 0, 0, i).ripple;
  const auto marks = score::falls_short({all.looked.scenarios, 1, failing.data(), ripple_v.data()},
                                        before.may_fail.data(), before.quiet_v, kept.data(), limits.choice);
  found.assign(marks.begin(), marks.end());
}

}  // extern "C"

}  // namespace greywhale::web
