// The closed loop of one candidate in the bench's own arithmetic: see closed_loop/experiment.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "arm/supply.h"
#include "closed_loop/experiment.h"
#include "closed_loop/firmware_tick.h"

namespace greywhale::loop {

namespace {

using arm::Potentiometers;
using Four = double[kJoints];

std::uint16_t count_of(double millivolts) {
  const double count = millivolts * 1024.0 / kConverterMillivolts;
  if (!(count > 0.0)) return 0;  // also where an arm's motion has left the range of numbers
  return static_cast<std::uint16_t>(std::min(count, double{kTopCount}));
}

// The converter's sums of one side's pots, from the slices' voltages as they come.
class Sums {
 public:
  Sums(const Timing& timing, std::size_t first) {
    for (std::size_t turn = 0; turn < kConversions; ++turn) {
      for (std::size_t joint = 0; joint < kJoints; ++joint) {
        const std::size_t slice = slice_of(timing, turn, first + joint);
        ++(slice < kSlices ? early_[slice][joint] : late_[joint]);
      }
    }
  }

  // A slice of the tick; its first slice also serves the end of the chain before.
  void hold(std::size_t slice, const Four& millivolts) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::uint16_t count = count_of(millivolts[i]);
      if (slice == 0) {
        done_[i] = static_cast<std::uint16_t>(sum_[i] + late_[i] * count);
        sum_[i] = 0;
      }
      sum_[i] = static_cast<std::uint16_t>(sum_[i] + early_[slice][i] * count);
    }
  }

  // Of the chain that has ended with the first slice of this tick.
  std::uint16_t operator[](std::size_t joint) const { return done_[joint]; }

  // As after standing still.
  void fill(const Four& millivolts) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::uint16_t count = count_of(millivolts[i]);
      sum_[i] = static_cast<std::uint16_t>((4u - late_[i]) * count);
    }
  }

 private:
  std::uint8_t early_[kSlices][kJoints] = {};
  std::uint8_t late_[kJoints] = {};
  std::uint16_t sum_[kJoints] = {};
  std::uint16_t done_[kJoints] = {};
};

// Filter and calibration of one side's pots.
class Angles {
 public:
  Angles(const Settings& settings, const Calibration& calibration)
      : shift_(settings.filter_shift), calibration_(calibration) {}

  std::int16_t next(std::size_t joint, std::uint16_t sum) {
    filtered_[joint] = low_pass(filtered_[joint], sum, primed_[joint] ? shift_ : 0);
    primed_[joint] = true;
    return to_angle(filtered_[joint], calibration_.zero[joint], calibration_.scale[joint]);
  }

 private:
  int shift_;
  const Calibration& calibration_;
  std::uint16_t filtered_[kJoints] = {};
  bool primed_[kJoints] = {};
};

arm::State<double> resting(const Experiment& x, const arm::Plant<double>& plant) {
  arm::State<double> s{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    s.q[i] = x.home[i];
    s.motor_q[i] = x.home[i] + x.gap[i] * plant.joints[i].gear.half_gap;
  }
  return s;
}

bool is_finite(const arm::State<double>& s) {
  double sum = 0.0;
  for (std::size_t i = 0; i < kJoints; ++i) sum += s.q[i] + s.v[i] + s.motor_q[i] + s.motor_v[i];
  return std::isfinite(sum);
}

// One candidate on its way through the experiment.
class Run {
 public:
  Run(const Experiment& x, const Controllers& controllers, const PlantRow& row, int substeps, const Trace& trace)
      : x_(x),
        controllers_(controllers),
        row_(row),
        substeps_(substeps),
        trace_(trace),
        pots_(with_sensors(x.pots, row.plant), x.pot_supply, x.seed),
        sums_(x.timing, kFollower),
        angles_(x.settings, x.settings.follower),
        ramp_(x.settings.soft_start_ms),
        state_(resting(x, row.plant)),
        worn_(arm::is_worn(row.plant)),
        sags_(row.supply.resistance > 0.0),
        loses_(arm::has_losses(row.plant.joints)),
        waiting_(static_cast<std::size_t>(x.timing.late)) {
    for (std::size_t i = 0; i < kJoints; ++i) fuzzy_pdi::reset(controllers[i], memories_[i]);
    Four millivolts;
    Potentiometers quiet(without_noise(x.pots), x.pot_supply, 0);
    quiet.millivolts(state_.q, millivolts);
    sums_.fill(millivolts);
  }

  Measures measures() {
    Measures total{};
    for (std::size_t tick = 0; tick < x_.ticks; ++tick) {
      Four volts;
      std::copy_n(volts_, kJoints, volts);
      pass_slice(tick, 0, volts);
      add(tick, total);
      control(tick);
      if (trace_.every != 0 && tick % trace_.every == 0) record(tick / trace_.every);
      for (std::size_t slice = 1; slice < kSlices; ++slice) {
        for (std::size_t i = 0; i < kJoints; ++i) {
          if (static_cast<int>(slice) >= x_.timing.acts[i]) volts[i] = volts_[i];
        }
        pass_slice(tick, slice, volts);
      }
      if (!is_finite(state_)) return diverged();
    }
    const double share = 1.0 / static_cast<double>(x_.ticks);
    for (double& mse : total.mse) mse *= share;
    return total;
  }

 private:
  static std::array<arm::Potentiometer, kJoints> without_noise(std::array<arm::Potentiometer, kJoints> pots) {
    for (arm::Potentiometer& pot : pots) pot.noise = 0.0;
    return pots;
  }

  static std::array<arm::Potentiometer, kJoints> with_sensors(std::array<arm::Potentiometer, kJoints> pots,
                                                              const arm::Plant<double>& plant) {
    for (std::size_t i = 0; i < kJoints; ++i) pots[i].sensor = plant.joints[i].sensor;
    return pots;
  }

  // The arm moves under the voltages found at the slice's beginning; the pots then show where it has come to.
  void pass_slice(std::size_t tick, std::size_t slice, const Four& volts) {
    static constexpr Four kNoLoad = {};
    if (kSlices * tick + slice > static_cast<std::size_t>(x_.timing.on)) {
      for (int n = 0; n < substeps_; ++n) {
        Four arriving;
        std::copy_n(volts, kJoints, arriving);
        if (sags_) arm::sag(row_.plant.joints, row_.supply, state_, arriving);
        if (loses_) arm::lose(row_.plant.joints, arriving);
        arm::advance(row_.plant, state_, arriving, kNoLoad, kSlice / substeps_, worn_);
      }
    }
    Four millivolts;
    pots_.millivolts(state_.q, millivolts);
    sums_.hold(slice, millivolts);
  }

  void control(std::size_t tick) {
    const bool on = tick > 0;
    const bool due = on && (tick - 1) % static_cast<std::size_t>(x_.settings.period_ms) == 0;
    const std::uint16_t limit = on ? ramp_.next_limit_mv(x_.settings.supply_mv) : std::uint16_t{0};
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::int16_t follower = angles_.next(i, sums_[i]);
      if (!due) continue;
      const std::int16_t reference =
          std::clamp(x_.reference[tick * kJoints + i], x_.settings.limit_min[i], x_.settings.limit_max[i]);
      const fuzzy_pdi::Output out = fuzzy_pdi::step(controllers_[i], memories_[i], reference, follower, limit);
      commanded_[i] = compare_value(out.volts_mv, duty_scale(x_.settings.pwm_top[i], x_.settings.supply_mv),
                                    x_.settings.motor_sign[i]);
    }
    act(tick);
  }

  // The duties that the firmware commands, or those of `late` ticks ago.
  void act(std::size_t tick) {
    compare_ = commanded_;
    if (!waiting_.empty()) std::swap(compare_, waiting_[tick % waiting_.size()]);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double size = std::abs(compare_[i]) / static_cast<double>(x_.settings.pwm_top[i]);
      volts_[i] = (compare_[i] < 0 ? -size : size) * row_.supply.volts;
    }
  }

  void add(std::size_t tick, Measures& total) const {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double error = x_.leader[tick * kJoints + i] - pots_.shown(i);
      total.mse[i] += error * error;
      total.itae[i] += kTick * x_.weight[tick] * std::fabs(error);
      total.itau[i] += kTick * x_.weight[tick] * std::fabs(volts_[i]);
    }
  }

  void record(std::size_t index) const {
    for (std::size_t i = 0; i < kJoints; ++i) {
      if (trace_.angles) trace_.angles[index * kJoints + i] = static_cast<float>(state_.q[i]);
      if (trace_.duties) trace_.duties[index * kJoints + i] = static_cast<std::int16_t>(compare_[i]);
    }
  }

  static Measures diverged() {
    Measures m{};
    for (std::size_t i = 0; i < kJoints; ++i) m.mse[i] = m.itae[i] = m.itau[i] = kDiverged;
    m.diverged = true;
    return m;
  }

  const Experiment& x_;
  const Controllers& controllers_;
  const PlantRow& row_;
  const int substeps_;
  const Trace& trace_;
  Potentiometers pots_;
  Sums sums_;
  Angles angles_;
  SoftStart ramp_;
  arm::State<double> state_;
  const bool worn_, sags_, loses_;
  fuzzy_pdi::State memories_[kJoints];
  std::array<std::int32_t, kJoints> commanded_ = {}, compare_ = {};
  std::vector<std::array<std::int32_t, kJoints>> waiting_;  // commanded, not acting yet
  Four volts_ = {};
};

}  // namespace

Measures run_exact(const Experiment& x, const Controllers& controllers, const PlantRow& row, int substeps,
                   const Trace& trace) {
  return Run(x, controllers, row, substeps, trace).measures();
}

void read_leader(const Settings& settings, const Timing& timing, Potentiometers pots, const double* angles,
                 std::size_t ticks, std::int16_t* reference, double* leader) {
  Sums sums(timing, kLeader);
  Angles readings(settings, settings.leader);
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    for (std::size_t slice = 0; slice < kSlices; ++slice) {
      Four now, millivolts;
      std::copy_n(angles + (tick * kSlices + slice) * kJoints, kJoints, now);
      pots.millivolts(now, millivolts);
      if (tick == 0 && slice == 0) sums.fill(millivolts);
      sums.hold(slice, millivolts);
      if (slice != 0) continue;
      for (std::size_t i = 0; i < kJoints; ++i) {
        reference[tick * kJoints + i] = readings.next(i, sums[i]);
        leader[tick * kJoints + i] = now[i];
      }
    }
  }
}

}  // namespace greywhale::loop
