// The plant in lanes; every lane has the bits of the plant in plain doubles. core.cmake compiles it once for each
// instruction set.
#include <algorithm>
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
    for (std::size_t n = 0; n < kLanes; ++n) load(n);
    worn_ = arm::is_worn(row_.plant);
    sags_ = any(row_.supply.resistance > Lanes(0.0));
    loses_ = arm::has_losses(row_.plant.joints);
    bool toothed = false;
    for (const arm::Joint<Lanes>& joint : row_.plant.joints) {
      plays_ = plays_ || any(joint.sensor.play > Lanes(0.0)) || any(joint.sensor.lag > Lanes(0.0));
      toothed = toothed || any(joint.gear.stiffness > Lanes(0.0));
    }
    if (toothed) lead();
    for (std::size_t n = 0; n < kLanes; ++n) begin(n);
  }

  void through() {
    std::size_t kept = 0;
    for (std::size_t row = 0; row < w_.rows; ++row) {
      if (row % w_.every == 0) {
        keep(kept);
        kept += kJoints;
      }
      std::size_t at[kLanes];
      for (std::size_t n = 0; n < kLanes; ++n) at[n] = first_[n] + row;
      const Lanes dt = step_of(at);
      if (plays_ && any(dt != seen_dt_)) prepare_look(dt);
      for (std::size_t step = 0; step < w_.substeps; ++step) {
        const Lanes no_load[kJoints] = {};
        Lanes volts[kJoints];
        arrive(at, step, volts);
        arm::advance(row_.plant, s_, volts, no_load, dt, worn_);
        if (plays_) look();
      }
    }
  }

 private:
  // Lanes without a task repeat the last one's.
  const Task& task(std::size_t n) const { return tasks_[n < count_ ? n : count_ - 1]; }

  void load(std::size_t n) {
    const Task& one = task(n);
    for (std::size_t c = 0; c < kColumns; ++c) reinterpret_cast<Lanes*>(&row_)[c].set(n, one.plant[c]);
    first_[n] = static_cast<std::size_t>(w_.first[one.window]);
    led_[n] = w_.led == nullptr ? 0 : static_cast<std::size_t>(w_.led[one.window]);
    for (std::size_t i = 0; i < kJoints; ++i) offset_[i].set(n, one.offset[i]);
  }

  // Where a link is whose potentiometer shows this.
  double link_angle(std::size_t n, std::size_t i, double shown, double velocity, double place) const {
    const arm::Sensor<Lanes>& sensor = row_.plant.joints[i].sensor;
    return shown + offset_[i][n] + velocity * sensor.lag[n] + place * sensor.play[n];
  }

  void begin(std::size_t n) {
    const std::size_t window = task(n).window * kJoints;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t at = window + i;
      const double velocity = w_.velocities[at], shown = w_.angles[at] + offset_[i][n];
      const double q = link_angle(n, i, w_.angles[at], velocity, w_.places[at]);
      shown_[i].after.set(n, shown);
      shown_[i].wiper.set(n, shown + velocity * row_.plant.joints[i].sensor.lag[n]);
      s_.motor_q[i].set(n, q + (s_.motor_q[i][n] - s_.q[i][n]));
      s_.motor_v[i].set(n, velocity + (s_.motor_v[i][n] - s_.v[i][n]));
      s_.q[i].set(n, q);
      s_.v[i].set(n, velocity);
    }
  }

  // The motors before a window, while the log leads the links: this tells where in its gap a motor stands when the
  // window begins, how far its teeth bend, and how fast it is.
  void lead() {
    std::size_t rows = 0;
    for (std::size_t n = 0; n < kLanes; ++n) rows = std::max(rows, led_[n]);
    for (std::size_t left = rows; left > 0; --left) {
      std::size_t at[kLanes];  // a lane with a shorter way stands where its way begins
      for (std::size_t n = 0; n < kLanes; ++n) {
        at[n] = first_[n] - std::min(led_[n], left);
        follow_log(n, at[n]);
        if (left >= led_[n]) stand(n);
      }
      const Lanes dt = step_of(at);
      for (std::size_t step = 0; step < w_.substeps; ++step) {
        Lanes volts[kJoints];
        arrive(at, step, volts);
        arm::advance_motors(row_.plant, s_, volts, dt, worn_);
      }
    }
    for (std::size_t n = 0; n < kLanes; ++n) {
      if (led_[n] == 0) stand(n);
    }
  }

  // A motor that no log has led yet stands where its side says, as fast as its link.
  void stand(std::size_t n) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double side = w_.sides[task(n).window * kJoints + i];
      s_.motor_q[i].set(n, s_.q[i][n] + side * row_.plant.joints[i].gear.half_gap[n]);
      s_.motor_v[i].set(n, s_.v[i][n]);
    }
  }

  void follow_log(std::size_t n, std::size_t row) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::size_t at = row * kJoints + i;
      const double velocity = w_.log_velocities[at];
      s_.q[i].set(n, link_angle(n, i, w_.log_angles[at], velocity, w_.log_places[at]));
      s_.v[i].set(n, velocity);
    }
  }

  // The voltages that arrive at the motors.
  void arrive(const std::size_t (&rows)[kLanes], std::size_t step, Lanes (&volts)[kJoints]) const {
    for (std::size_t n = 0; n < kLanes; ++n) {
      const double* now = w_.volts + (rows[n] * w_.substeps + step) * kJoints;
      for (std::size_t i = 0; i < kJoints; ++i) volts[i].set(n, now[i]);
    }
    if (sags_) arm::sag(row_.plant.joints, row_.supply, s_, volts);
    if (loses_) arm::lose(row_.plant.joints, volts);
  }

  Lanes step_of(const std::size_t (&rows)[kLanes]) const {
    Lanes dt;
    for (std::size_t n = 0; n < kLanes; ++n) dt.set(n, w_.spacing[rows[n]]);
    return dt / static_cast<double>(w_.substeps);
  }

  void prepare_look(Lanes dt) {
    seen_dt_ = dt;
    for (std::size_t i = 0; i < kJoints; ++i) lags_[i] = arm::lag_of(row_.plant.joints[i].sensor.lag, dt);
  }

  void look() {
    for (std::size_t i = 0; i < kJoints; ++i) arm::follow(row_.plant.joints[i].sensor, lags_[i], s_.q[i], shown_[i]);
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
  arm::State<Lanes> s_{};
  arm::Shown<Lanes> shown_[kJoints];
  arm::Lag<Lanes> lags_[kJoints];
  Lanes seen_dt_ = Lanes(0.0);
  Lanes offset_[kJoints];
  std::size_t first_[kLanes] = {}, led_[kLanes] = {};
  bool worn_ = false, sags_ = false, loses_ = false, plays_ = false;
};

void simulate(const Windows& w, const Task* tasks, std::size_t count) { Run(w, tasks, count).through(); }

}  // namespace

const Kernel kKernel = {simulate, kLanes};

}  // namespace greywhale::windows::GREYWHALE_INSTRUCTIONS
