// One experiment with the closed loop: everything that all candidates share. Times are whole slices of 250 us, four to
// a tick of 1 ms, as on the bench: sensors hold their value and motors their voltage for a slice. During tick 0 the
// firmware is asked to enable; the controllers run from tick 1 on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "arm/arm.h"
#include "arm/potentiometer.h"
#include "fuzzy_pdi.h"

namespace greywhale::loop {

constexpr std::size_t kJoints = arm::kJoints;
constexpr std::size_t kSlices = 4;  // in a tick
constexpr double kTick = 1e-3;      // s
constexpr double kSlice = kTick / kSlices;

constexpr std::size_t kConversions = 4;  // of each potentiometer in a tick
constexpr double kConverterMillivolts = 5000.0;
constexpr std::int32_t kTopCount = 1023;

// When things happen within a tick, in cycles of the 16 MHz clock and in slices counted from the one in which the tick
// begins. The converter visits the eight pots in turn, four times.
struct Timing {
  static constexpr int kSliceCycles = 4000;
  static constexpr int kConversionCycles = 416;
  static constexpr int kHoldCycles = 48;  // from a conversion's start until it holds its input
  int start;          // of the first conversion, after the beginning of the slice in which the tick begins
  int acts[kJoints];  // the slice in which a joint's new voltage begins to act, 1 or later
  int on;             // the slice in which the drivers are first found on, 1..4; the hand lets go one later
  int late;           // ticks by which every duty acts later than the firmware's; 0 on the board
};

// The pots of a round in their order: the followers' come first.
constexpr std::size_t kFollower = 0, kLeader = kJoints;

// The slice in which conversion `turn` of the round's pot `place` holds its input: 4 is the next tick's first.
constexpr std::size_t slice_of(const Timing& timing, std::size_t turn, std::size_t place) {
  const int number = static_cast<int>(8 * turn + place);
  return static_cast<std::size_t>((timing.start + number * Timing::kConversionCycles + Timing::kHoldCycles) /
                                  Timing::kSliceCycles);
}

// How the firmware turns four conversions into an angle.
struct Calibration {
  std::uint16_t zero[kJoints];
  std::int16_t scale[kJoints];
};

struct Settings {
  int period_ms;
  std::uint16_t supply_mv;
  std::uint16_t soft_start_ms;  // 0: at full voltage from the first tick
  int filter_shift;
  std::int16_t limit_min[kJoints], limit_max[kJoints];  // q12
  int motor_sign[kJoints];
  int pwm_top[kJoints];  // compare value of full duty
  Calibration leader, follower;
};

struct Experiment {
  Settings settings;
  Timing timing;
  std::array<arm::Potentiometer, kJoints> pots;  // of the follower; play and lag are the plant's
  double pot_supply;                             // V
  std::uint64_t seed;                            // of the follower's potentiometer noise
  double home[kJoints];                          // rad, where the follower is held until the motors are on
  double gap[kJoints];                           // -1..1, where in its gap each gear then stands
  std::size_t ticks;
  const std::int16_t* reference;  // ticks x 4: the leader's angle as the firmware reads it, q12
  const double* leader;           // ticks x 4: the follower's angle that reads as the leader does then, rad
  const double* weight;           // ticks: of |e| and |u| in ITAE and ITAU, s
  const float* noise;             // (4 x ticks + 1) x 4: of the pots in counts, for lanes (noise_of); null: none
};

struct Measures {
  double mse[kJoints];   // rad^2, mean over the ticks
  double itae[kJoints];  // rad s^2
  double itau[kJoints];  // V s^2
  bool diverged;
};

// What every measure of a candidate becomes whose motion leaves the range of numbers.
constexpr double kDiverged = 1e9;

// Optional outputs, every `every`-th tick; null where not wanted.
struct Trace {
  std::size_t every;
  float* angles;         // rows x 4, rad, when the tick begins
  std::int16_t* duties;  // rows x 4, compare values with the direction as sign, from this tick on
};

// A plant as a row of numbers.
struct PlantRow {
  arm::Plant<double> plant;
  arm::Supply<double> supply;
};
constexpr std::size_t kPlantColumns = sizeof(PlantRow) / sizeof(double);

using Controllers = std::array<fuzzy_pdi::Coefficients, kJoints>;

// The bench's own arithmetic in double precision; each slice in `substeps` steps of the arm.
Measures run_exact(const Experiment& experiment, const Controllers& controllers, const PlantRow& row, int substeps,
                   const Trace& trace);

// The leader's readings and true angles at every tick from its angles (rad) in every slice: slices x 4 -> ticks x 4.
void read_leader(const Settings& settings, const Timing& timing, arm::Potentiometers pots, const double* angles,
                 std::size_t ticks, std::int16_t* reference, double* leader);

}  // namespace greywhale::loop
