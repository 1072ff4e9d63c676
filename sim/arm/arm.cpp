// Arm: see arm.h.
#include "arm.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "motor.h"
#include "supply.h"

namespace greywhale::arm {

namespace {

[[noreturn]] void refuse(const std::string& what, double value, const char* remedy) {
  throw std::invalid_argument(what + " is " + std::to_string(value) + "; " + remedy + ".");
}

void require_finite(const char* what, const double (&values)[kJoints]) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (!std::isfinite(values[i]))
      refuse(what + (" of joint " + std::to_string(i)), values[i], "it must be a finite number");
  }
}

bool is_finite(const State<double>& s) {
  bool finite = true;
  for (std::size_t i = 0; i < kJoints; ++i) {
    finite = finite && std::isfinite(s.q[i]) && std::isfinite(s.v[i]) && std::isfinite(s.motor_q[i]) &&
             std::isfinite(s.motor_v[i]);
  }
  return finite;
}

}  // namespace

Arm::Arm(const ArmParameters& parameters, std::uint64_t seed, double longest_step)
    : worn_(false), loses_(false), drive_(parameters.drive), noise_(seed, 0), longest_step_(longest_step) {
  if (!(std::isfinite(longest_step) && longest_step > 0.0))
    refuse("the longest step", longest_step, "it must be a time above 0 s");
  plant_.body = rigid_body(parameters);
  for (std::size_t i = 0; i < kJoints; ++i) plant_.joints[i] = parameters.joints[i];
  worn_ = is_worn(plant_);
  loses_ = has_losses(plant_.joints);
  double start[kJoints];
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Stops<double>& stops = plant_.joints[i].stops;
    start[i] = std::fmin(std::fmax(0.0, stops.min), stops.max);
  }
  reset(start);
}

void Arm::reset(const double (&angles)[kJoints]) {
  require_finite("the angle", angles);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Stops<double>& stops = plant_.joints[i].stops;
    if (angles[i] < stops.min || angles[i] > stops.max) {
      const std::string range =
          "it must lie between the stops, " + std::to_string(stops.min) + " to " + std::to_string(stops.max) + " rad";
      refuse("the angle of joint " + std::to_string(i), angles[i], range.c_str());
    }
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double within = 2.0 * noise_.uniform(resets_ * kJoints + i) - 1.0;
    state_.q[i] = angles[i];
    state_.motor_q[i] = angles[i] + within * plant_.joints[i].gear.half_gap;
    state_.v[i] = 0.0;
    state_.motor_v[i] = 0.0;
  }
  ++resets_;
}

void Arm::step(const double (&volts)[kJoints], double dt) {
  require_finite("the voltage", volts);
  if (!(std::isfinite(dt) && dt > 0.0)) refuse("the time step", dt, "it must be a time above 0 s");
  double applied[kJoints];
  for (std::size_t i = 0; i < kJoints; ++i) applied[i] = applied_voltage(drive_, volts[i]);

  // A hair of slack, so that 1 ms is four steps of 0.25 ms and not five.
  const double count = std::fmax(1.0, std::ceil(dt / longest_step_ * (1.0 - 1e-9)));
  const double h = dt / count;
  State<double> next = state_;
  std::uint64_t unsettled = 0;
  for (double n = 0.0; n < count; n += 1.0) {
    double arriving[kJoints];
    for (std::size_t i = 0; i < kJoints; ++i) arriving[i] = applied[i];
    if (drive_.supply.resistance > 0.0) sag(plant_.joints, drive_.supply, next, arriving);
    if (loses_) lose(plant_.joints, arriving);
    unsettled += advance(plant_, next, arriving, load_, h, worn_) ? 0u : 1u;
  }
  if (!is_finite(next)) throw std::runtime_error("the arm's motion left the range of numbers; check its parameters.");
  state_ = next;
  steps_ += static_cast<std::uint64_t>(count);
  unsettled_ += unsettled;
}

void Arm::set_load(const double (&torques)[kJoints]) {
  require_finite("the load", torques);
  for (std::size_t i = 0; i < kJoints; ++i) load_[i] = torques[i];
}

double Arm::kinetic_energy() const {
  const Geometry<double> geometry = geometry_of(plant_.body, pose_of<double>(state_.q[1], state_.q[2]));
  double energy = arm::kinetic_energy(geometry.mass, state_.v);
  for (std::size_t i = 0; i < kJoints; ++i)
    energy += 0.5 * plant_.joints[i].actuator.inertia * state_.motor_v[i] * state_.motor_v[i];
  return energy;
}

double Arm::potential_energy() const {
  double energy = arm::potential_energy(plant_.body, pose_of<double>(state_.q[1], state_.q[2]));
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Gear<double>& gear = plant_.joints[i].gear;
    const double bent = std::fmax(std::fabs(state_.motor_q[i] - state_.q[i]) - gear.half_gap, 0.0);
    energy += 0.5 * gear.stiffness * bent * bent;
  }
  return energy;
}

}  // namespace greywhale::arm
