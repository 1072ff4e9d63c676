#include "score/unrest.h"

#include <algorithm>
#include <cmath>

#include "closed_loop/swings.h"
#include "share_out.h"

namespace greywhale::score {

namespace {

// Of one rest; whether it fails is said of all together.
std::array<Unrest, kJoints> unrest_in(const Run& run, std::size_t n, const std::array<std::size_t, 2>& ticks,
                                      const Rests& rests, double supply_v, const SwingMeasure& measure) {
  const std::size_t from = (n * run.ticks + ticks[0]) * kJoints, rows = ticks[1] - ticks[0];
  const double seconds = static_cast<double>(rows) * loop::kTick;
  const auto beats = duty_swings(run.duties + from, rows, run.pwm_top, measure.duty_share);
  loop::Swings swings[kJoints];
  loop::swings_of<kJoints>(run.angles + from, rows, rests.band_rad, swings);
  std::array<Unrest, kJoints> found{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double squares =
        loop::ripple_of(run.duties + from + i, rows, kJoints, static_cast<std::size_t>(measure.ripple_ticks));
    const bool cycles = swings[i].reversals >= rests.turns;
    found[i] = {static_cast<double>(swings[i].reversals),
                cycles ? swings[i].travel / seconds : 0.0,
                beats[i] / seconds,
                supply_v * (std::sqrt(squares) / run.pwm_top[i]),
                0.0,
                0.0};
  }
  return found;
}

// Of a joint at rest, the mean over the plants; 0 where that is not looked at.
double ripple_price(const Looked& looked, std::size_t n, std::size_t joint, double quiet_v,
                    const MarginLimits& limits) {
  const auto found = std::find(looked.scenarios.begin(), looked.scenarios.end(), Scenario::rest);
  if (found == looked.scenarios.end()) return 0.0;
  const auto rest = static_cast<std::size_t>(found - looked.scenarios.begin());
  double ripple = 0.0;
  for (std::size_t plant = 0; plant < looked.plants; ++plant) ripple += looked.at(rest, n, plant, joint).ripple;
  const double share = ripple / static_cast<double>(looked.plants) / quiet_v;
  const double beyond = larger(share - limits.search_ripple_share, 0.0);
  return limits.ripple_price * share + limits.loud_price * beyond;
}

// The mean over the plants.
double scenario_price(const Looked& looked, std::size_t scenario, std::size_t n, std::size_t joint,
                      const MarginLimits& limits) {
  const bool soft = looked.scenarios[scenario] == Scenario::soft_teeth;
  const double fail_price = soft ? limits.teeth_price : limits.fail_price;
  double sum = 0.0;
  for (std::size_t plant = 0; plant < looked.plants; ++plant) {
    const Unrest& one = looked.at(scenario, n, plant, joint);
    sum += limits.travel_price * one.travel + fail_price * one.fails + limits.lost_price * one.lost;
  }
  return sum / static_cast<double>(looked.plants);
}

}  // namespace

std::vector<Unrest> unrest_of(const Run& run, const Rests& rests, double supply_v, const SwingBounds& swings,
                              const SwingMeasure& measure) {
  std::vector<Unrest> worst(run.count * kJoints, Unrest{});
  share_out(run.count, 0, [&](std::size_t n) {
    std::array<double, kJoints> squares{};  // of the ripple, times the ticks
    double rows = 0.0;
    for (const auto& ticks : rests.ticks) {
      const auto here = static_cast<double>(ticks[1] - ticks[0]);
      rows += here;
      const std::array<Unrest, kJoints> found = unrest_in(run, n, ticks, rests, supply_v, measure);
      for (std::size_t i = 0; i < kJoints; ++i) {
        Unrest& one = worst[n * kJoints + i];
        one.reversals = larger(one.reversals, found[i].reversals);
        one.travel = larger(one.travel, found[i].travel);
        one.chatter = larger(one.chatter, found[i].chatter);
        squares[i] += here * found[i].ripple * found[i].ripple;
      }
    }
    for (std::size_t i = 0; i < kJoints; ++i) {
      Unrest& one = worst[n * kJoints + i];
      one.ripple = rows > 0.0 ? std::sqrt(squares[i] / rows) : 0.0;
      one.lost = run.diverged[n];
      one.fails = one.reversals >= rests.turns || one.chatter > swings.chatter_at_rest_hz || run.diverged[n];
    }
  });
  return worst;
}

double quiet_ripple(double ripple_before, double supply_v, const SwingBounds& swings) {
  return larger(ripple_before, swings.quiet_share * supply_v);
}

std::vector<double> unrest_prices(const Looked& looked, const std::array<double, kJoints>& quiet_v,
                                  const MarginLimits& limits) {
  std::vector<double> prices(looked.count * kJoints);
  for (std::size_t n = 0; n < looked.count; ++n) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      double& price = prices[n * kJoints + i];
      price = ripple_price(looked, n, i, quiet_v[i], limits);
      for (std::size_t scenario = 0; scenario < looked.scenarios.size(); ++scenario)
        price += scenario_price(looked, scenario, n, i, limits);
    }
  }
  return prices;
}

std::vector<double> failing_in(const Looked& looked) {
  std::vector<double> plants;
  for (std::size_t scenario = 0; scenario < looked.scenarios.size(); ++scenario) {
    for (std::size_t n = 0; n < looked.count; ++n) {
      for (std::size_t i = 0; i < kJoints; ++i) {
        double count = 0.0;
        for (std::size_t plant = 0; plant < looked.plants; ++plant) count += looked.at(scenario, n, plant, i).fails;
        plants.push_back(count);
      }
    }
  }
  return plants;
}

std::vector<char> falls_short(const Seen& seen, const double* may_fail, const std::array<double, kJoints>& quiet_v,
                              const bool* kept, const ChoiceLimits& limits) {
  const std::size_t size = seen.count * kJoints;
  std::vector<char> marks(size);
  for (std::size_t at = 0; at < size; ++at) {
    const double most = kept[at] ? limits.shaken_ripple : limits.same_ripple;
    bool falls = seen.ripple_v[at] > most * quiet_v[at % kJoints];
    for (std::size_t scenario = 0; scenario < seen.scenarios.size(); ++scenario) {
      const bool counts = seen.scenarios[scenario] != Scenario::soft_teeth;
      falls |= counts && seen.failing[scenario * size + at] > may_fail[scenario * kJoints + at % kJoints];
    }
    marks[at] = falls;
  }
  return marks;
}

}  // namespace greywhale::score
