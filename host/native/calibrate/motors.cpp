// A motor is judged by short weak pulses: which joint it moves, and which way.
#include <algorithm>
#include <cmath>

#include "calibrate/rules.h"
#include "calibrate/text.h"

namespace greywhale::calibrate {
namespace {

constexpr double kLeastWay = 0.02;  // rad, half of what lies between pulses both ways: less is no motion
constexpr double kWeakShare = 0.5;  // of the others' way a volt: healthy joints are above 0.6, weak ones below 0.45
constexpr double kMuchSupplyShare = 0.2;  // if every motor needs so much of the supply, the supply is low
constexpr double kOtherJointRatio = 2.0;  // another joint that moves so many times farther has this motor

// The limits of a pulse.
constexpr double kLeaseMs = 160.0;  // motors off by the firmware, whatever the host does; soft start is 100 of it
constexpr double kSettleMs = 250.0;
constexpr double kStillMs = 200.0, kStill = 0.008;  // rad: an arm that still falls would hide a weak pulse
constexpr double kPatienceMs = 5000.0;
constexpr double kStep = 0.08;         // rad
constexpr double kFarthest = 0.16;     // rad, of a joint from where it should be: twice a pulse's step
constexpr double kStiffKp = 64.0;      // so that a small error already gets the whole voltage of the pulse
constexpr double kWidestLimit = 6.28;  // rad, the widest that a board takes

// Half of what lies between a pulse and one the other way, of each joint.
std::vector<double> between(const double* one, const double* other) {
  std::vector<double> half(kJoints);
  for (std::size_t joint = 0; joint < kJoints; ++joint) half[joint] = (one[joint] - other[joint]) / 2.0;
  return half;
}

std::size_t farthest_of(const std::vector<double>& way) {
  const auto nearer = [](double one, double other) { return std::abs(one) < std::abs(other); };
  return static_cast<std::size_t>(std::max_element(way.begin(), way.end(), nearer) - way.begin());
}

// Where two tries agree, the smaller; else 0. An arm that falls when nobody holds it falls in one pulse and lies still
// in the next, so the second try has the other order.
void keep_what_agrees(std::vector<double>& way, const std::vector<double>& again) {
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const double size = std::min(std::abs(way[joint]), std::abs(again[joint]));
    way[joint] = way[joint] * again[joint] > 0.0 ? std::copysign(size, way[joint]) : 0.0;
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 != 0 ? values[middle] : (values[middle - 1] + values[middle]) / 2.0;
}

}  // namespace

Answer motor(Given given) {
  const auto joint = static_cast<std::size_t>(given.next());
  if (joint >= kJoints) throw std::out_of_range("a motor is one of four.");
  const double supply = given.next();
  double volts = 0.0;
  for (const double share : kPulseShares) {
    volts = share * supply;
    if (given.left() < kJoints) return {{volts, 1.0}, ""};
    const double* one = given.some(kJoints);
    if (given.left() < kJoints) return {{volts, -1.0}, ""};
    std::vector<double> way = between(one, given.some(kJoints));
    if (std::abs(way[farthest_of(way)]) < kLeastWay) continue;
    if (given.left() < kJoints) return {{volts, -1.0}, ""};
    one = given.some(kJoints);
    if (given.left() < kJoints) return {{volts, 1.0}, ""};
    keep_what_agrees(way, between(given.some(kJoints), one));
    const std::size_t farthest = farthest_of(way);
    const double own = std::abs(way[joint]);
    if (std::abs(way[farthest]) < kLeastWay) continue;
    if (farthest != joint && std::abs(way[farthest]) > kOtherJointRatio * own)
      return {{},
              text("the motor of joint %d moved joint %d: their motors, or their followers' potentiometers, are "
                   "swapped; exchange the wires at the board, and begin anew.",
                   static_cast<int>(joint), static_cast<int>(farthest))};
    if (own >= kLeastWay) return {{way[joint] > 0.0 ? 1.0 : -1.0, volts, own}, ""};
  }
  return {{},
          text("the motor of joint %d did not move it with %.1f V: check that the motors' supply is on, the driver's "
               "enable, PWM and direction wires, the motor's own wires, and that the joint moves freely.",
               static_cast<int>(joint), volts)};
}

Answer pulse(Given given) {
  const double joint = given.next(), volts = given.next();
  std::string set = text(
      "period_ms 1\nsoft_start_ms 100\ntracking_limit %g\ntracking_ms 1\nstall_volts 0\nunrest_amplitude 0", kFarthest);
  for (int other = 0; other < static_cast<int>(kJoints); ++other) {
    const double ku_mv = other == joint ? std::nearbyint(1000.0 * volts) : 0.0;
    const auto add = [&set, other](const char* name, double value) {
      add_line(set, text("joint%d.%s %g", other, name, value));
    };
    add("kp", kStiffKp), add("kd", 0.0), add("ki", 0.0), add("ku_mv", ku_mv);
    add("limit_min", -kWidestLimit), add("limit_max", kWidestLimit);
  }
  return {{kLeaseMs, kSettleMs, kStillMs, kPatienceMs, kStep, kStill}, set};
}

Answer remarks(Given given) {
  const double supply = given.next();
  const std::size_t count = given.left() / 3;
  const double* rows = given.some(3 * count);
  Answer answer;
  if (count == 0) return answer;
  std::vector<double> answers(count);  // rad a volt
  double least = rows[1];
  for (std::size_t n = 0; n < count; ++n) {
    least = std::min(least, rows[3 * n + 1]);
    answers[n] = rows[3 * n + 2] / rows[3 * n + 1];
  }
  if (least >= kMuchSupplyShare * supply) {
    answer.words = text(
        "Every motor needed %.1f V or more to move its joint: check the motors' supply; the board counts "
        "on %g V (supply_mv).",
        least, supply);
    return answer;
  }
  for (std::size_t n = 0; n < count; ++n) {
    std::vector<double> others = answers;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(n));
    const double usual = median(others);
    if (answers[n] < kWeakShare * usual)
      add_line(answer.words,
               text("The motor of joint %d moved it by %.0f mrad a volt, the others theirs by %.0f: it is weak, or "
                    "its joint turns hard; check its wires, its driver's current limit, and that the joint turns "
                    "freely by hand.",
                    static_cast<int>(rows[3 * n]), 1e3 * answers[n], 1e3 * usual));
  }
  return answer;
}

}  // namespace greywhale::calibrate
