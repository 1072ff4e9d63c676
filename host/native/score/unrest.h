// How candidates come to rest, what unrest costs, and who falls short of the standard for an upload.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "score/limits.h"
#include "score/run.h"
#include "score/swing_measure.h"

namespace greywhale::score {

// Of a joint on a plant in one scenario: the worst of its rests; the ripple is of all rests, as a log shows it.
struct Unrest {
  double reversals;
  double travel;   // rad/s, in swings of a limit cycle
  double chatter;  // 1/s, duty swings
  double ripple;   // V rms
  double fails;    // 1: hunts, chatters or is lost
  double lost;     // 1: left the range of numbers
};

// The ticks of each rest, and the fewest turns by more than a band that are a limit cycle.
struct Rests {
  std::vector<std::array<std::size_t, 2>> ticks;
  double band_rad, turns;
};

// Of each candidate and joint, count x 4.
std::vector<Unrest> unrest_of(const Run& run, const Rests& rests, double supply_v, const SwingBounds& swings,
                              const SwingMeasure& measure);

// As greywhale/tune/judge/margins.py numbers them.
enum class Scenario { rest, half_gain, twice_gain, soft_teeth, delay, moving };

// The unrest of `count` candidates on `plants` in some scenarios: scenarios x count x plants x 4.
struct Looked {
  std::vector<Scenario> scenarios;
  std::size_t count, plants;
  const Unrest* unrest;

  const Unrest& at(std::size_t scenario, std::size_t n, std::size_t plant, std::size_t joint) const {
    return unrest[((scenario * count + n) * plants + plant) * kJoints + joint];
  }
};

// The ripple that is allowed at rest: that from before, or a share of the supply.
double quiet_ripple(double ripple_before, double supply_v, const SwingBounds& swings);

// Prices of candidates, count x 4, mostly for scenarios that fail.
std::vector<double> unrest_prices(const Looked& looked, const std::array<double, kJoints>& quiet_v,
                                  const MarginLimits& limits);

// On how many plants each joint fails: scenarios x count x 4.
std::vector<double> failing_in(const Looked& looked);

// What was seen of candidates: on how many plants each joint fails (scenarios x count x 4), and its ripple at rest on
// the worst of them (count x 4).
struct Seen {
  std::vector<Scenario> scenarios;
  std::size_t count;
  const double *failing, *ripple_v;
};

// Who falls short of what may fail (scenarios x 4 plants) and sound, count x 4; `kept` marks joints that keep their
// controller. Softer teeth are no part of it.
std::vector<char> falls_short(const Seen& seen, const double* may_fail, const std::array<double, kJoints>& quiet_v,
                              const bool* kept, const ChoiceLimits& limits);

}  // namespace greywhale::score
