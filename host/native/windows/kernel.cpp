// The plant in lanes; every lane has the bits of the plant in plain doubles. core.cmake compiles it once for each
// instruction set.
#include <cstddef>

#include "arm/sensor.h"
#include "arm/step.h"
#include "arm/supply.h"
#include "closed_loop/experiment.h"
#include "double_lanes.h"
#include "windows.h"

namespace greywhale::windows::GREYWHALE_INSTRUCTIONS {

using arm::kJoints;

namespace {

// A plant as lanes, with the supply that feeds it.
struct Row {
  arm::Plant<Lanes> plant;
  arm::Supply<Lanes> supply;
};
constexpr std::size_t kColumns = sizeof(loop::PlantRow) / sizeof(double);
static_assert(sizeof(Row) == kColumns * sizeof(Lanes));

// One window of each lane.
class Run {
 public:
  Run(const Windows& w, const Task* tasks, std::size_t count) : w_(w), tasks_(tasks), count_(count) {
    for (std::size_t n = 0; n < kLanes; ++n) begin(n);
    worn_ = arm::is_worn(row_.plant);
    sags_ = any(row_.supply.resistance > Lanes(0.0));
    loses_ = arm::has_losses(row_.plant.joints);
    for (const arm::Joint<Lanes>& joint : row_.plant.joints)
      plays_ = plays_ || any(joint.sensor.play > Lanes(0.0)) || any(joint.sensor.lag > Lanes(0.0));
  }

  void through() {
    const Lanes no_load[kJoints] = {};
    std::size_t kept = 0;
    for (std::size_t row = 0; row < w_.rows; ++row) {
      if (row % w_.every == 0) {
        keep(kept);
        kept += kJoints;
      }
      const Lanes dt = step_of(row);
      for (std::size_t step = 0; step < w_.substeps; ++step) {
        Lanes volts[kJoints];
        read_volts(row * w_.substeps + step, volts);
        if (sags_) arm::sag(row_.plant.joints, row_.supply, s_, volts);
        if (loses_) arm::lose(row_.plant.joints, volts);
        arm::advance(row_.plant, s_, volts, no_load, dt, worn_);
        if (plays_) look(dt);
      }
    }
  }

 private:
  // Lanes without a task repeat the last one's.
  const Task& task(std::size_t n) const { return tasks_[n < count_ ? n : count_ - 1]; }

  void begin(std::size_t n) {
    const Task& one = task(n);
    for (std::size_t c = 0; c < kColumns; ++c) reinterpret_cast<Lanes*>(&row_)[c].set(n, one.plant[c]);
    first_[n] = static_cast<std::size_t>(w_.first[one.window]);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t at = one.window * kJoints + i;
      const arm::Sensor<Lanes>& sensor = row_.plant.joints[i].sensor;
      const double velocity = w_.velocities[at], shown = w_.angles[at] + one.offset[i];
      const double wiper = shown + velocity * sensor.lag[n], q = wiper + w_.places[at] * sensor.play[n];
      offset_[i].set(n, one.offset[i]);
      shown_[i].after.set(n, shown);
      shown_[i].wiper.set(n, wiper);
      s_.q[i].set(n, q);
      s_.v[i].set(n, velocity);
      s_.motor_q[i].set(n, q + w_.sides[at] * row_.plant.joints[i].gear.half_gap[n]);
      s_.motor_v[i].set(n, velocity);
    }
  }

  Lanes step_of(std::size_t row) const {
    Lanes dt;
    for (std::size_t n = 0; n < kLanes; ++n) dt.set(n, w_.spacing[first_[n] + row]);
    return dt / static_cast<double>(w_.substeps);
  }

  void read_volts(std::size_t step, Lanes (&volts)[kJoints]) const {
    for (std::size_t n = 0; n < kLanes; ++n) {
      const double* now = w_.volts + (first_[n] * w_.substeps + step) * kJoints;
      for (std::size_t i = 0; i < kJoints; ++i) volts[i].set(n, now[i]);
    }
  }

  void look(Lanes dt) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const arm::Sensor<Lanes>& sensor = row_.plant.joints[i].sensor;
      arm::follow(sensor, arm::lag_of(sensor.lag, dt), s_.q[i], shown_[i]);
    }
  }

  void keep(std::size_t kept) const {
    for (std::size_t n = 0; n < count_; ++n) {
      for (std::size_t i = 0; i < kJoints; ++i)
        tasks_[n].out[kept + i] = (plays_ ? shown_[i].after : s_.q[i])[n] - offset_[i][n];
    }
  }

  const Windows& w_;
  const Task* const tasks_;
  const std::size_t count_;
  Row row_;
  arm::State<Lanes> s_;
  arm::Shown<Lanes> shown_[kJoints];
  Lanes offset_[kJoints];
  std::size_t first_[kLanes] = {};
  bool worn_ = false, sags_ = false, loses_ = false, plays_ = false;
};

void simulate(const Windows& w, const Task* tasks, std::size_t count) { Run(w, tasks, count).through(); }

}  // namespace

const Kernel kKernel = {simulate, kLanes};

}  // namespace greywhale::windows::GREYWHALE_INSTRUCTIONS
