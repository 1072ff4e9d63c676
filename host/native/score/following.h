// How candidates follow a motion, and what it costs beside what is possible. tune/search/objective.py has the formulas.
#pragma once

#include <cstddef>
#include <vector>

#include "score/limits.h"
#include "score/run.h"
#include "score/swing_measure.h"

namespace greywhale::score {

// Of a joint on a plant in a class of motion.
struct Errors {
  double error;    // rad
  double volts;    // V, weighted mean of |u|
  double rattle;   // rad rms
  double chatter;  // 1/s
};

// What is possible there, and what was before, in rad; `room` is the way from the floor to the error before.
struct Scale {
  double floor, room, rattle;
};

// The error in rad, of the weighted mean of |e| and the mean of e^2.
double error_of(double weighted, double square, const CostLimits& limits);

double room_of(double error_before, double floor, const CostLimits& limits);

// Of each candidate and joint, count x 4; `total_weight` is the integral of the weights of ITAE and ITAU.
std::vector<Errors> follow(const Run& run, const Rattle& rattle, double total_weight, const SwingMeasure& measure,
                           const CostLimits& limits);

// Of a joint on a plant in a class of motion.
double relative_cost(const Errors& found, const Scale& scale, double supply_v, const CostLimits& limits,
                     const SwingBounds& swings);

// Of each joint over all plants and classes: from relative costs, plants x classes x 4.
std::array<double, kJoints> total_costs(const double* relative, std::size_t plants,
                                        const std::vector<double>& importances, const CostLimits& limits);

}  // namespace greywhale::score
