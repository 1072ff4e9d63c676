// What a candidate costs (score/). greywhale.tune keeps the limits and explains them; use that, not this.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "score/following.h"
#include "score/unrest.h"
#include "share_out.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace score = greywhale::score;

namespace {

using greywhale::bind::Array;
using greywhale::bind::In;
using score::kJoints;

// Structs of plain numbers come and go as arrays, whose last axis has a struct's fields.
template <class T>
constexpr std::size_t kNumbers = sizeof(T) / sizeof(double);
template <class T>
using Numbers = In<double, nb::shape<kNumbers<T>>>;

template <class T>
const T& struct_of(const Numbers<T>& numbers) {
  return *reinterpret_cast<const T*>(numbers.data());
}

template <class T>
nb::object rows_of(const std::vector<T>& values, std::size_t count) {
  Array<double> rows({count, kJoints, kNumbers<T>});
  std::copy_n(reinterpret_cast<const double*>(values.data()), values.size() * kNumbers<T>, rows.data());
  return rows.numpy();
}

using Measure = Numbers<score::SwingMeasure>;
using Cost = Numbers<score::CostLimits>;
using Bounds = Numbers<score::SwingBounds>;
using Quiet = std::array<double, kJoints>;
using Each = In<double, nb::shape<-1, kJoints>>;
using Joints = std::array<int, kJoints>;
using ErrorRows = In<double, nb::shape<-1, -1, -1, kJoints, kNumbers<score::Errors>>>;
using ScaleRows = In<double, nb::shape<-1, -1, kJoints, kNumbers<score::Scale>>>;
using CostRows = In<double, nb::shape<-1, -1, -1, kJoints>>;
using UnrestRows = In<double, nb::shape<-1, -1, -1, kJoints, kNumbers<score::Unrest>>>;

void require(bool sound, const char* otherwise) {
  if (!sound) throw std::invalid_argument(otherwise);
}

// A greywhale.loop.Result with a row a tick, which keeps the arrays.
score::Run run_of(const nb::object& result, const Joints& pwm_top) {
  const auto field = [&result](const char* name, auto kind) {
    return nb::cast<decltype(kind)>(result.attr(name), false);
  };
  const auto mse = field("mse", Each{}), itae = field("itae", Each{}), itau = field("itau", Each{});
  const auto diverged = field("diverged", In<bool, nb::shape<-1>>{});
  const auto angles = field("angles", In<float, nb::shape<-1, -1, kJoints>>{});
  const auto duties = field("duties", In<std::int16_t, nb::shape<-1, -1, kJoints>>{});
  const std::size_t count = angles.shape(0);
  require(mse.shape(0) == count && itae.shape(0) == count && itau.shape(0) == count && diverged.shape(0) == count &&
              duties.shape(0) == count && duties.shape(1) == angles.shape(1),
          "measures and traces differ in number or length.");
  return {count,           angles.shape(1), mse.data(),    itae.data(), itau.data(),
          diverged.data(), angles.data(),   duties.data(), pwm_top};
}

nb::object follow(const nb::object& result, const Joints& pwm_top, const Each& leader, double total_weight,
                  std::size_t first_block, const Measure& measure, const Cost& cost) {
  const score::Run run = run_of(result, pwm_top);
  require(leader.shape(0) == run.ticks, "angles and leader differ in length.");
  const score::SwingMeasure& how = struct_of<score::SwingMeasure>(measure);
  const score::Rattle beyond(leader.data(), run.ticks, first_block, how);
  std::vector<score::Errors> found;
  {
    const nb::gil_scoped_release free;
    found = score::follow(run, beyond, total_weight, how, struct_of<score::CostLimits>(cost));
  }
  return rows_of(found, run.count);
}

nb::object errors_of(const Each& weighted, const Each& square, const Cost& cost) {
  require(weighted.shape(0) == square.shape(0), "weighted and square differ in length.");
  Array<double> errors({weighted.shape(0), kJoints});
  for (std::size_t at = 0; at < weighted.size(); ++at)
    errors.data()[at] = score::error_of(weighted.data()[at], square.data()[at], struct_of<score::CostLimits>(cost));
  return errors.numpy();
}

nb::object rooms_of(const In<double, nb::shape<-1, -1, kJoints>>& before,
                    const In<double, nb::shape<-1, -1, kJoints>>& floor, const Cost& cost) {
  require(before.size() == floor.size(), "before and floor differ in shape.");
  Array<double> rooms({floor.shape(0), floor.shape(1), kJoints});
  for (std::size_t at = 0; at < floor.size(); ++at)
    rooms.data()[at] = score::room_of(before.data()[at], floor.data()[at], struct_of<score::CostLimits>(cost));
  return rooms.numpy();
}

nb::object relative_costs(const ErrorRows& found, const ScaleRows& scale, double supply_v, const Cost& cost,
                          const Bounds& swings) {
  const std::size_t count = found.shape(0), plants = found.shape(1), classes = found.shape(2);
  require(scale.shape(0) == plants && scale.shape(1) == classes, "errors and scale differ in plants or classes.");
  Array<double> costs({count, plants, classes, kJoints});
  const auto* errors = reinterpret_cast<const score::Errors*>(found.data());
  const auto* scales = reinterpret_cast<const score::Scale*>(scale.data());
  const std::size_t each = plants * classes * kJoints;
  for (std::size_t at = 0; at < count * each; ++at)
    costs.data()[at] = score::relative_cost(errors[at], scales[at % each], supply_v, struct_of<score::CostLimits>(cost),
                                            struct_of<score::SwingBounds>(swings));
  return costs.numpy();
}

nb::object total_costs(const CostRows& relative, const std::vector<double>& importances, const Cost& cost) {
  const std::size_t count = relative.shape(0), each = relative.shape(1) * relative.shape(2) * kJoints;
  require(relative.shape(2) == importances.size(), "every class needs its importance.");
  Array<double> costs({count, kJoints});
  for (std::size_t n = 0; n < count; ++n) {
    const auto totals = score::total_costs(relative.data() + n * each, relative.shape(1), importances,
                                           struct_of<score::CostLimits>(cost));
    std::copy(totals.begin(), totals.end(), costs.data() + n * kJoints);
  }
  return costs.numpy();
}

nb::object unrest(const nb::object& result, const Joints& pwm_top, const std::vector<std::array<std::size_t, 2>>& rests,
                  double band_rad, double turns, double supply_v, const Bounds& swings, const Measure& measure) {
  const score::Run run = run_of(result, pwm_top);
  const score::SwingMeasure& how = struct_of<score::SwingMeasure>(measure);
  for (const auto& [first, last] : rests)
    require(first <= last && last <= run.ticks && static_cast<double>(last - first) >= how.ripple_ticks,
            "each rest must lie within the traces, and be longer than the mean that is no ripple.");
  std::vector<score::Unrest> found;
  {
    const nb::gil_scoped_release free;
    found = score::unrest_of(run, {rests, band_rad, turns}, supply_v, struct_of<score::SwingBounds>(swings), how);
  }
  return rows_of(found, run.count);
}

std::vector<score::Scenario> scenarios_of(const std::vector<int>& numbers) {
  std::vector<score::Scenario> scenarios;
  for (const int number : numbers) scenarios.push_back(static_cast<score::Scenario>(number));
  return scenarios;
}

nb::object unrest_prices(const std::vector<int>& scenarios, const UnrestRows& unrest, const Quiet& quiet_v,
                         const Numbers<score::MarginLimits>& margins) {
  require(scenarios.size() == unrest.shape(0), "every scenario needs its unrest.");
  const score::Looked looked{scenarios_of(scenarios), unrest.shape(1), unrest.shape(2),
                             reinterpret_cast<const score::Unrest*>(unrest.data())};
  const auto found = score::unrest_prices(looked, quiet_v, struct_of<score::MarginLimits>(margins));
  Array<double> prices({looked.count, kJoints});
  std::copy(found.begin(), found.end(), prices.data());
  return prices.numpy();
}

nb::object falls_short(const std::vector<int>& scenarios, const In<double, nb::shape<-1, -1, kJoints>>& failing,
                       const Each& ripple_v, const Each& may_fail, const Quiet& quiet_v,
                       const In<bool, nb::shape<-1, kJoints>>& kept, const Numbers<score::ChoiceLimits>& choice) {
  const std::size_t count = ripple_v.shape(0);
  require(failing.shape(0) == scenarios.size() && may_fail.shape(0) == scenarios.size(),
          "every scenario needs what fails and what may fail.");
  require(failing.shape(1) == count && kept.shape(0) == count, "failing, ripple_v and kept differ in length.");
  const score::Seen seen{scenarios_of(scenarios), count, failing.data(), ripple_v.data()};
  const auto found =
      score::falls_short(seen, may_fail.data(), quiet_v, kept.data(), struct_of<score::ChoiceLimits>(choice));
  Array<bool> marks({count, kJoints});
  std::copy(found.begin(), found.end(), marks.data());
  return marks.numpy();
}

}  // namespace

void bind_score(nb::module_& m) {
  m.def("follow", &follow, nb::kw_only(), "result"_a, "pwm_top"_a, "leader"_a.noconvert(), "total_weight"_a,
        "first_block"_a, "measure"_a, "cost"_a, "Error, volts, rattle and chatter: n x 4 x 4.");
  m.def("errors_of", &errors_of, nb::kw_only(), "weighted"_a, "square"_a, "cost"_a,
        "Errors (n x 4) in rad, of weighted means of |e| and means of e^2.");
  m.def("rooms_of", &rooms_of, nb::kw_only(), "before"_a, "floor"_a, "cost"_a,
        "The room from each floor to the error before, plants x classes x 4.");
  m.def("relative_costs", &relative_costs, nb::kw_only(), "found"_a, "scale"_a, "supply_v"_a, "cost"_a, "swings"_a,
        "Costs n x plants x classes x 4, of errors (... x 4) beside a scale of floor, room and rattle.");
  m.def("total_costs", &total_costs, nb::kw_only(), "relative"_a, "importances"_a, "cost"_a,
        "Costs n x 4 over all plants and classes.");
  m.def("unrest", &unrest, nb::kw_only(), "result"_a, "pwm_top"_a, "rests"_a, "band_rad"_a, "turns"_a, "supply_v"_a,
        "swings"_a, "measure"_a,
        "Reversals, travel, chatter, fails and lost of the worst rest, and fourth the ripple of all rests: n x 4 x 6.");
  m.def("unrest_prices", &unrest_prices, nb::kw_only(), "scenarios"_a, "unrest"_a, "quiet_v"_a, "margins"_a,
        "Prices n x 4 of the unrest in some scenarios, scenarios x n x plants x 4 x 6.");
  m.def("falls_short", &falls_short, nb::kw_only(), "scenarios"_a, "failing"_a, "ripple_v"_a, "may_fail"_a, "quiet_v"_a,
        "kept"_a, "choice"_a, "Who falls short of the standard, n x 4.");
  m.def(
      "quiet_ripple",
      [](double ripple_before, double supply_v, const Bounds& swings) {
        return score::quiet_ripple(ripple_before, supply_v, struct_of<score::SwingBounds>(swings));
      },
      nb::kw_only(), "ripple_before"_a, "supply_v"_a, "swings"_a, "The ripple (V) that is allowed at rest.");
}
