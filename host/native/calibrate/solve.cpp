// From sweeps and held poses to zero, scale and limits, as the board stores them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calibrate/rules.h"
#include "calibrate/text.h"

namespace greywhale::calibrate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kCount14PerCount = 16.0;  // in a count of the converter
constexpr double kAngleDivisor = 8192.0;   // angle = (count14 - zero) * scale / 2^13
constexpr double kShortestTrack = 180.0 * (kPi / 180.0), kLongestTrack = 450.0 * (kPi / 180.0);  // no longer on a board
constexpr double kLeastTurn = 0.3;      // rad between two poses: with less, a degree in a hand is much of the scale
constexpr double kSlippedCounts = 8.0;  // the same pose twice: 40 mrad of a usual track
constexpr double kMostApart = 0.15;   // rad between the arms in the last pose: 9 degrees, more than a hand is wrong by
constexpr double kStillCounts = 3.0;  // of the means of a held pose
constexpr std::size_t kMeanRows = 100;

int whole(std::size_t number) { return static_cast<int>(number); }

struct Joints {
  explicit Joints(Given& given) {
    for (bool& one : in_use) one = given.next() != 0.0;
  }
  bool have_pot(std::size_t pot) const { return in_use[pot % kJoints]; }
  bool in_use[kJoints] = {};
};

struct Sweeps {
  explicit Sweeps(Given& given) : directions(given.some(kPots)), low(given.some(kPots)), high(given.some(kPots)) {}
  const double *directions, *low, *high;
};

struct Pose {
  explicit Pose(Given& given) : angles(given.some(kJoints)), counts(given.some(kPots)) {}
  const double *angles, *counts;
};

std::string poses_alike(const double* first, const double* second, const Joints& joints) {
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const double turned = second[joint] - first[joint];
    if (joints.in_use[joint] && std::abs(turned) < kLeastTurn)
      return text(
          "the two poses differ by %.2g rad at joint %d; choose a second pose that differs by %g rad or more "
          "at every joint.",
          turned, whole(joint), kLeastTurn);
  }
  return "";
}

// The scale of a potentiometer from two poses, which must agree with the direction of its sweep.
std::string scale_of(const Pose& first, const Pose& second, std::size_t pot, double direction, double& scale) {
  const double turned = second.angles[pot % kJoints] - first.angles[pot % kJoints];
  const double moved = second.counts[pot] - first.counts[pot];
  const double track = moved != 0.0 ? std::abs(turned / moved) * kFullScale : std::numeric_limits<double>::infinity();
  if (!(kShortestTrack <= track && track <= kLongestTrack))
    return pot_name(pot) + text(
                               " read %.0f and %.0f in the two poses: as if its track had %.0f degrees; hold the poses "
                               "again, and check that its shaft does not slip.",
                               first.counts[pot], second.counts[pot], track * (180.0 / kPi));
  scale = turned / moved;
  if ((scale > 0.0) != (direction > 0.0))
    return pot_name(pot) +
           " turned the other way between the poses than in its sweep; in the sweep, turn towards the positive end "
           "first.";
  return "";
}

// Both arms' ends at a joint, in rad.
struct Ends {
  Ends(const Sweeps& sweeps, const std::vector<double>& zero, const std::vector<double>& scale, std::size_t joint) {
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const std::size_t pot = arm * kJoints + joint;
      const double one = (sweeps.low[pot] - zero[pot]) * scale[pot];
      const double other = (sweeps.high[pot] - zero[pot]) * scale[pot];
      low[arm] = std::min(one, other), high[arm] = std::max(one, other);
    }
  }
  double low[2], high[2];
};

// Zeros and scales, and what both arms can reach, without the margin.
Answer with_limits(const Joints& joints, const Sweeps& sweeps, const std::vector<double>& zero,
                   const std::vector<double>& scale) {
  Answer answer{zero, ""};
  answer.numbers.insert(answer.numbers.end(), scale.begin(), scale.end());
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const Ends ends(sweeps, zero, scale, joint);
    const double low = std::max(ends.low[0], ends.low[1]) + kMargin;
    const double high = std::min(ends.high[0], ends.high[1]) - kMargin;
    answer.numbers.insert(answer.numbers.end(), {low, high});
    if (joints.in_use[joint] && !(low < high) && answer.words.empty())
      answer.words = text(
          "joint %d has no range that both arms can reach: the leader goes from %.2f to %.2f rad, the "
          "follower from %.2f to %.2f; hold both arms in the same pose, and sweep to both ends.",
          whole(joint), ends.low[0], ends.high[0], ends.low[1], ends.high[1]);
  }
  return answer;
}

}  // namespace

Answer counts(Given given) {
  const double *scale = given.some(kPots), *zero = given.some(kPots);
  std::vector<double> counts(given.left());
  for (std::size_t at = 0; at < counts.size(); ++at) {
    const std::size_t pot = at % kPots;
    const double angle = given.next();
    // Without a potentiometer, of scale 0, the middle: nobody knows, and nothing is wrong.
    counts[at] =
        scale[pot] != 0.0 ? (angle * kAngleDivisor / scale[pot] + zero[pot]) / kCount14PerCount : kFullScale / 2.0;
  }
  return {counts, ""};
}

Answer held(Given given) {
  const std::size_t rows = given.left() / kPots;
  const double* counts = given.some(rows * kPots);
  const auto mean = [counts](std::size_t pot, std::size_t from, std::size_t to) {
    double sum = 0.0;
    for (std::size_t row = from; row < to; ++row) sum += counts[row * kPots + pot];
    return sum / static_cast<double>(to - from);
  };
  std::vector<double> means(kPots), wandered(kPots);
  for (std::size_t pot = 0; pot < kPots; ++pot) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t row = 0; row + kMeanRows <= rows; row += kMeanRows) {
      const double part = mean(pot, row, row + kMeanRows);
      low = std::min(low, part), high = std::max(high, part);
    }
    means[pot] = mean(pot, 0, rows), wandered[pot] = high - low;
  }
  const auto worst = std::max_element(wandered.begin(), wandered.end());
  if (*worst <= kStillCounts) return {means, ""};
  return {{},
          pot_first(static_cast<std::size_t>(worst - wandered.begin())) +
              text(" moved by %.0f counts; hold both arms still.", *worst)};
}

Answer require_apart(Given given) {
  const double *first = given.some(kJoints), *second = given.some(kJoints);
  return {{}, poses_alike(first, second, Joints(given))};
}

Answer solve(Given given) {
  const Joints joints(given);
  const Sweeps sweeps(given);
  const Pose first(given);
  std::vector<double> zero(kPots), scale(kPots, 1.0);
  if (given.left() == 1) {
    const double track = given.next();
    for (std::size_t pot = 0; pot < kPots; ++pot) scale[pot] = sweeps.directions[pot] * track / kFullScale;
  } else {
    const Pose second(given);
    std::string mistake = poses_alike(first.angles, second.angles, joints);
    for (std::size_t pot = 0; pot < kPots && mistake.empty(); ++pot)
      if (joints.have_pot(pot)) mistake = scale_of(first, second, pot, sweeps.directions[pot], scale[pot]);
    if (!mistake.empty()) return {{}, mistake};
  }
  for (std::size_t pot = 0; pot < kPots; ++pot)
    zero[pot] = first.counts[pot] - first.angles[pot % kJoints] / scale[pot];
  return with_limits(joints, sweeps, zero, scale);
}

Answer match(Given given) {
  const Joints joints(given);
  const Sweeps sweeps(given);
  std::vector<double> zero(kPots), scale(kPots);
  for (double& one : zero) one = given.next();
  for (double& one : scale) one = given.next();
  const Pose first(given);
  const double* same = given.some(kPots);
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const std::size_t pot = kJoints + joint;
    const double turned = (same[joint] - zero[joint]) * scale[joint] - first.angles[joint];
    if (joints.in_use[joint] && std::abs(turned) >= kLeastTurn) scale[pot] = turned / (same[pot] - first.counts[pot]);
    zero[pot] = first.counts[pot] - first.angles[joint] / scale[pot];
  }
  return with_limits(joints, sweeps, zero, scale);
}

Answer slipped(Given given) {
  const double *before = given.some(kPots), *after = given.some(kPots);
  std::string moved;
  bool named[kPots / kJoints] = {};  // an arm is, and counts are, once: eight full names fill nine lines of a terminal
  for (std::size_t pot = 0; pot < kPots; ++pot) {
    const double apart = std::abs(after[pot] - before[pot]);
    if (apart <= kSlippedCounts) continue;
    bool& arm = named[pot / kJoints];
    moved += (moved.empty() ? "" : ", ") + (arm ? text("%d", whole(pot % kJoints)) : pot_name(pot)) +
             text(moved.empty() ? " (by %.0f counts)" : " (%.0f)", apart);
    arm = true;
  }
  Answer answer;
  if (!moved.empty())
    answer.words = "elsewhere than in the first pose: " + moved +
                   "; hold that pose again, and if it was held, tighten what slips on its shaft, and begin anew.";
  return answer;
}

Answer apart(Given given) {
  const Joints joints(given);
  const double *zero = given.some(kPots), *scale = given.some(kPots), *counts = given.some(kPots);
  const auto angle = [=](std::size_t pot) { return (counts[pot] - zero[pot]) * scale[pot]; };
  Answer answer;
  std::size_t worst = 0;
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    answer.numbers.push_back(joints.in_use[joint] ? std::abs(angle(kJoints + joint) - angle(joint)) : 0.0);
    if (answer.numbers[joint] > answer.numbers[worst]) worst = joint;
  }
  if (answer.numbers[worst] > kMostApart)
    answer.words = text(
        "held in the same pose, leader and follower differ by %.2f rad at joint %d; hold the poses more "
        "exactly, check that no shaft slips, and begin anew.",
        answer.numbers[worst], whole(worst));
  return answer;
}

Answer raw(Given given) {
  double value = given.next();
  const double least = given.next(), most = given.next(), unit = given.next();
  const double low = least * unit, high = most * unit;
  if (given.next() != 0.0) value = std::min(std::max(value, low), high);
  if (value >= low && value <= high) return {{std::floor(value / unit + 0.5)}, ""};
  return {{}, text("would be %.6g, but it must lie within %.6g..%.6g; begin anew.", value, low, high)};
}

}  // namespace greywhale::calibrate
