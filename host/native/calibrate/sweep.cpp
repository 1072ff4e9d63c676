// One joint of one arm turned by hand to both ends, the positive one first: what its potentiometer shows, and mistakes.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calibrate/rules.h"
#include "calibrate/text.h"

namespace greywhale::calibrate {
namespace {

constexpr std::size_t kSmoothRows = 9;  // a reading that differs from its neighbours for less time is a jump
constexpr double kLeastCounts = 40.0;   // 12 degrees of a usual track: less is no sweep
constexpr double kOthersShare = 0.5;    // of the sweep: another reading that moves as far is moved as well
constexpr double kRailCounts = 4.0;     // from the end of the converter's range
// A pull-down of some ten times the track.
constexpr double kCrossedFromCounts = 0.88 * kFullScale, kCrossedSpanCounts = 0.12 * kFullScale;
// A jump so far, from near one end to near the other, crosses the gap of the track.
constexpr double kDeadZoneCounts = 300.0;
constexpr std::size_t kDeadZoneRows = 8;
constexpr double kJumpCounts = 15.0;
constexpr int kMostJumps = 2;

// A potentiometer's readings, as they came and without what is shorter than a few rows.
struct Column {
  std::vector<double> raw, smooth;
  double low = std::numeric_limits<double>::infinity(), high = -low;

  double span() const { return high - low; }
  std::string reading() const {
    return text("%d to %d of %d", static_cast<int>(std::nearbyint(low)), static_cast<int>(std::nearbyint(high)),
                static_cast<int>(kFullScale));
  }
};

// The median of each value and its neighbours; the ends count as often as is needed.
Column column_of(const double* counts, std::size_t rows, std::size_t pot) {
  constexpr std::size_t half = kSmoothRows / 2;
  Column column;
  column.raw.resize(rows), column.smooth.resize(rows);
  for (std::size_t row = 0; row < rows; ++row) column.raw[row] = counts[row * kPots + pot];
  std::array<double, kSmoothRows> near{};
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < kSmoothRows; ++i)
      near[i] = column.raw[std::min(std::max(row + i, half) - half, rows - 1)];
    std::nth_element(near.begin(), near.begin() + half, near.end());
    const double median = near[half];
    column.smooth[row] = median;
    column.low = std::min(column.low, median), column.high = std::max(column.high, median);
  }
  return column;
}

bool jumps_across(const Column& column) {
  const std::vector<double>& values = column.smooth;
  for (std::size_t at = kDeadZoneRows; at < values.size(); ++at)
    if (std::abs(values[at] - values[at - kDeadZoneRows]) > kDeadZoneCounts) return true;
  return false;
}

// True if it stays near 5 V but is at no rail: a pull-down makes that of an end of the track on the pin.
bool is_crossed(const Column& column) {
  return column.low > kCrossedFromCounts && column.high < kFullScale - kRailCounts && column.span() > kRailCounts &&
         column.span() < kCrossedSpanCounts;
}

std::string dead_zone(std::size_t pot) {
  return pot_first(pot) +
         " jumps from one end of its track to the other within the joint's range: its dead zone lies there; "
         "turn its shaft by half a turn in its coupling and begin anew.";
}

std::string crossed(const Column& own, std::size_t pot) {
  return pot_first(pot) + " reads " + own.reading() +
         " and hardly changes near 5 V: its wiper's wire and an end's are exchanged; the wiper is mostly the middle "
         "one "
         "of the three. Change them: near an end of the track this shorts 5 V to ground.";
}

using Columns = std::array<Column, kPots>;

// A joint was turned: the mistake if another potentiometer moved as well.
std::string also_moved(const Columns& columns, std::size_t pot, const std::vector<std::size_t>& others) {
  std::vector<std::size_t> also;
  for (const std::size_t other : others)
    if (columns[other].span() > kOthersShare * columns[pot].span()) also.push_back(other);
  for (const std::size_t other : also)  // it stands at an end of its track, and noise alone makes it jump
    if (jumps_across(columns[other])) return dead_zone(other);
  if (also.empty()) return "";
  return pot_first(pot) + " moved, and so did " + pot_name(also[0]) +
         ": turn one joint at a time, or if only one was turned, look for a wire that touches both.";
}

// The potentiometer did not move: the mistake.
std::string not_moved(const Columns& columns, std::size_t pot, const std::vector<std::size_t>& others) {
  const Column& own = columns[pot];
  if (others.empty() && is_crossed(own)) return crossed(own, pot);
  const std::string begin = pot_first(pot) + " reads " + own.reading();
  if (!others.empty()) {
    const std::size_t moved = *std::max_element(
        others.begin(), others.end(),
        [&columns](std::size_t one, std::size_t other) { return columns[one].span() < columns[other].span(); });
    return begin + " and did not move, but " + pot_name(moved) +
           " did: " + (moved % kJoints == pot % kJoints ? "the two arms are swapped" : "their wires are swapped") +
           ", or the other joint was turned; exchange the wires at the board's pins, or do it again.";
  }
  if (own.high <= kRailCounts || own.low >= kFullScale - kRailCounts)
    return begin +
           ", at a rail: check its wiper and its 5V wire (an open wire or a short to ground reads 0), or its ground "
           "wire (1023).";
  return begin +
         " and did not move: check that its shaft turns with the joint (a slipping coupling, a loose screw) and that "
         "its wiper's wire is connected.";
}

std::string wiring(const Columns& columns, std::size_t pot) {
  std::vector<std::size_t> others;
  for (std::size_t other = 0; other < kPots; ++other)
    if (other != pot && columns[other].span() >= kLeastCounts) others.push_back(other);
  return columns[pot].span() >= kLeastCounts ? also_moved(columns, pot, others) : not_moved(columns, pot, others);
}

int jumps_of(const Column& own) {
  int jumps = 0;
  bool before = true;  // a record that begins away has not jumped
  for (std::size_t at = 0; at < own.raw.size(); ++at) {
    const bool away = std::abs(own.raw[at] - own.smooth[at]) > kJumpCounts;
    jumps += away && !before ? 1 : 0;
    before = away;
  }
  return jumps;
}

// The mistake if the track ends or breaks where the joint goes, or its contact is bad.
std::string contact(const Column& own, std::size_t pot) {
  if (is_crossed(own)) return crossed(own, pot);
  if (jumps_across(own)) return dead_zone(pot);
  if (own.low <= kRailCounts || own.high >= kFullScale - kRailCounts)
    return pot_first(pot) + " reaches an end of its track (" + own.reading() +
           ") within the joint's range: turn its shaft in its coupling so that mid-range reads about 512, and begin "
           "anew.";
  const int jumps = jumps_of(own);
  if (jumps <= kMostJumps) return "";
  return pot_first(pot) + text(
                              " jumped %d times while the joint was turned: a loose wire, or a worn track; check its "
                              "three wires, else replace it.",
                              jumps);
}

}  // namespace

Answer sweep(Given given) {
  const auto pot = static_cast<std::size_t>(given.next());
  const std::size_t rows = given.left() / kPots;
  const double* counts = given.some(rows * kPots);
  if (pot >= kPots || rows == 0) throw std::out_of_range("a sweep is of one of eight potentiometers, and has rows.");
  Columns columns;
  for (std::size_t one = 0; one < kPots; ++one) columns[one] = column_of(counts, rows, one);
  const Column& own = columns[pot];
  std::string mistake = wiring(columns, pot);
  if (mistake.empty()) mistake = contact(own, pot);
  const auto [least, most] = std::pair(std::min_element(own.smooth.begin(), own.smooth.end()),
                                       std::max_element(own.smooth.begin(), own.smooth.end()));
  return {{most < least ? 1.0 : -1.0, own.low, own.high}, mistake};
}

}  // namespace greywhale::calibrate
