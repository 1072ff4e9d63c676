#include "score/following.h"

#include <cmath>
#include <numeric>

#include "share_out.h"

namespace greywhale::score {

double error_of(double weighted, double square, const CostLimits& limits) {
  return weighted + limits.rms_weight * std::sqrt(square);
}

double room_of(double error_before, double floor, const CostLimits& limits) {
  const double least = larger(limits.least_room_share * floor, limits.least_room_rad);
  return larger(error_before - floor, least);
}

std::vector<Errors> follow(const Run& run, const Rattle& rattle, double total_weight, const SwingMeasure& measure,
                           const CostLimits& limits) {
  std::vector<Errors> found(run.count * kJoints);
  const double seconds = static_cast<double>(run.ticks) * loop::kTick;
  share_out(run.count, 0, [&](std::size_t n) {
    const std::size_t from = n * run.ticks * kJoints;
    const auto shaken = rattle.of(run.angles + from);
    const auto swings = duty_swings(run.duties + from, run.ticks, run.pwm_top, measure.duty_share);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t at = n * kJoints + i;
      const double error = error_of(run.itae[at] / total_weight, run.mse[at], limits);
      const bool lost = run.diverged[n];
      found[at] = {lost ? limits.lost_cost : error, run.itau[at] / total_weight, lost ? limits.lost_cost : shaken[i],
                   swings[i] / seconds};
    }
  });
  return found;
}

double relative_cost(const Errors& found, const Scale& scale, double supply_v, const CostLimits& limits,
                     const SwingBounds& swings) {
  const double louder = larger(found.rattle - larger(scale.rattle, limits.unheard_rad), 0.0);
  // One joint may come out a little below its floor, where a neighbour carries it.
  const double avoidable = larger(found.error - scale.floor, 0.0);
  const double length = avoidable + limits.rattle_weight * (found.rattle + limits.louder_weight * louder);
  const double unbearable = larger(found.chatter / swings.chatter_moving_hz - limits.bearable_share, 0.0);
  const double shaking = larger(found.rattle / swings.rattle_moving_rad - limits.bearable_share, 0.0);
  const double share = length / scale.room + limits.chatter_weight * unbearable + limits.shaking_weight * shaking;
  return std::sqrt(share + limits.effort_weight * found.volts / supply_v);
}

std::array<double, kJoints> total_costs(const double* relative, std::size_t plants,
                                        const std::vector<double>& importances, const CostLimits& limits) {
  const double whole = std::accumulate(importances.begin(), importances.end(), 0.0);
  std::array<double, kJoints> totals{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    double sum = 0.0, worst = 0.0;
    for (std::size_t plant = 0; plant < plants; ++plant) {
      double cost = 0.0;
      for (std::size_t c = 0; c < importances.size(); ++c)
        cost += importances[c] * relative[(plant * importances.size() + c) * kJoints + i];
      cost /= whole;
      sum += cost;
      worst = plant ? larger(worst, cost) : cost;
    }
    const double mean = sum / static_cast<double>(plants);
    totals[i] = (1.0 - limits.worst_plant_share) * mean + limits.worst_plant_share * worst;
  }
  return totals;
}

}  // namespace greywhale::score
