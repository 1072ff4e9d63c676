// Observer: see observer.h.
#include "observe/observer.h"

#include <algorithm>
#include <cmath>

#include "arm/elementary.h"
#include "arm/friction.h"
#include "arm/supply.h"

namespace greywhale::observe {

namespace {

// Of white noise behind s / (1 + Ts)^2 and s^2 / (1 + Ts)^3: integrals over all frequencies.
constexpr double kSpeedNoise = 0.25, kTorqueNoise = 0.1875;

// rad/s, about which friction turns over.
constexpr double kTurning = 0.02;

double share_of(double dt, double time_constant) {
  return time_constant > 0.0 ? 1.0 - arm::exponential(-dt / time_constant) : 1.0;
}

double squared(double value) { return value * value; }
double cubed(double value) { return value * squared(value); }

int sign_of(double value) { return (value > 0.0) - (value < 0.0); }

// What gravity asks of the joints less what their motion gives: -dL/dq.
void potential_torque(const arm::Geometry<double>& g, const Four& v, Four& torque) {
  const double square = 0.5 * v[0] * v[0];
  const double rolling = g.roll * v[0] * v[3];
  torque[0] = torque[3] = 0.0;
  torque[1] = g.gravity1 - 2.0 * g.half_d1 * square - rolling;
  torque[2] = g.gravity2 - 2.0 * g.half_d2 * square - rolling + g.wrist * v[1] * (v[1] + v[2]);
}

}  // namespace

void Observer::start(const Four& angles) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    first_[i].value = second_[i].value = angles[i];
    slow_[i] = delayed_[i] = half_driven_[i] = driven_[i] = Lag{};
    speed_[i] = acceleration_[i] = integral_[i] = residual_[i] = passed_[i] = friction_[i] = 0.0;
  }
}

// The motors' torques, behind the low-passes of the angles and what delays a reading.
void Observer::drive_motors(double dt, const Four& volts, double filter_s, double delay_s) {
  const arm::Joint<double>(&joints)[kJoints] = row_.plant.joints;
  Four arriving, motor_v;
  for (std::size_t i = 0; i < kJoints; ++i) {
    arriving[i] = std::clamp(volts[i], -row_.supply.volts, row_.supply.volts);
    motor_v[i] = speed_[i];
  }
  if (row_.supply.resistance > 0.0) {
    Four duty;
    for (std::size_t i = 0; i < kJoints; ++i) duty[i] = arriving[i] / row_.supply.volts;
    const double share = arm::voltage_share(joints, row_.supply, motor_v, duty);
    for (double& one : arriving) one *= share;
  }
  arm::lose(joints, arriving);
  const double share = share_of(dt, filter_s);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double late = delay_s + joints[i].sensor.lag;
    delayed_[i].follow(joints[i].actuator.torque_per_volt * arriving[i], share_of(dt, late));
    half_driven_[i].follow(delayed_[i].value, share);
    driven_[i].follow(half_driven_[i].value, share);
  }
}

void Observer::step(double dt, const Four& angles, const Four& volts, double filter_s, double delay_s) {
  drive_motors(dt, volts, filter_s, delay_s);
  const double share = share_of(dt, filter_s);
  for (std::size_t i = 0; i < kJoints; ++i) {
    first_[i].follow(angles[i], share);
    // As differences of what is filtered, they are as late as the voltages, which are held from sample to sample.
    const double angle_before = second_[i].value, speed_before = slow_[i].value;
    second_[i].follow(first_[i].value, share);
    speed_[i] = (second_[i].value - angle_before) / dt;
    slow_[i].follow(speed_[i], share);
    acceleration_[i] = (slow_[i].value - speed_before) / dt;
  }
  const arm::Geometry<double> geometry =
      arm::geometry_of(row_.plant.body, arm::pose_of<double>(second_[1].value, second_[2].value));
  Four momentum, potential;
  arm::momentum_of(geometry.mass, speed_, momentum);
  potential_torque(geometry, speed_, potential);
  const double links[kJoints] = {geometry.mass.m00, geometry.mass.m11, geometry.mass.m22, geometry.mass.m33};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const arm::Joint<double>& joint = row_.plant.joints[i];
    const double v = speed_[i];
    link_inertia_[i] = links[i];
    inertia_[i] = links[i] + joint.actuator.inertia;
    momentum[i] += joint.actuator.inertia * v;
    // Friction turns over within the noise of the speed, so that it has no jump there.
    const double slip = v / std::sqrt(squared(v) + squared(kTurning));
    const double dry = arm::friction_torque(joint.friction, v);
    const double left = driven_[i].value - joint.actuator.damping * v - joint.actuator.inertia * acceleration_[i];
    passed_[i] = (left - dry * slip) / (1.0 + joint.friction.load * slip * sign_of(left - dry * slip));
    friction_[i] = dry + joint.friction.load * std::fabs(passed_[i]);
    const double known = driven_[i].value - joint.actuator.damping * v - friction_[i] * slip - potential[i];
    // The residual's own feedback is taken at the end of the step: stable at any spacing.
    residual_[i] = (momentum[i] - integral_[i] - dt * known) / (filter_s + dt);
    integral_[i] += dt * (known + residual_[i]);
  }
}

double Observer::stall(std::size_t i) const {
  return row_.plant.joints[i].actuator.torque_per_volt * row_.supply.volts;
}

double Observer::held(std::size_t i) const {
  const arm::Friction<double>& friction = row_.plant.joints[i].friction;
  return friction.breakaway + friction.load * std::fabs(passed_[i]);
}

Ensemble::Ensemble(const loop::PlantRow* rows, std::size_t count, const Limits& limits, const Four& noise,
                   double delay_s)
    : arms_(rows, rows + count), limits_(limits), delay_s_(delay_s) {
  std::copy_n(noise, kJoints, noise_);
}

void Ensemble::step(double time_s, const Four& angles, const Four& volts, Seen (&seen)[kJoints]) {
  const double dt = time_s - time_s_;
  if (fresh_ || dt <= 0.0 || dt > limits_.restart_s) {
    for (Observer& one : arms_) one.start(angles);
    for (std::size_t i = 0; i < kJoints; ++i) {
      tracks_[i] = Track{};
      seen[i] = {0.0, known_width(i) + arms_[0].held(i), Sight::turning, false};
    }
    fresh_ = false;
    begun_s_ = 0.0;
  } else {
    begun_s_ += dt;
    for (Observer& one : arms_) one.step(dt, angles, volts_, limits_.filter_s, delay_s_);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Sight sight = look(i, dt);
      const double held = sight == Sight::told ? 0.0 : arms_[0].held(i);
      seen[i] = {arms_[0].torque(i), known_width(i) + held, sight, false};
      if (begun_s_ >= limits_.begin_s) judge_contact(i, dt, seen[i]);
    }
  }
  time_s_ = time_s;
  std::copy_n(volts, kJoints, volts_);
}

Sight Ensemble::look(std::size_t i, double dt) {
  const Observer& arm = arms_[0];
  const arm::Joint<double>& joint = arm.row().plant.joints[i];
  Track& track = tracks_[i];
  if (!arm::has_room(joint.stops)) return Sight::unused;
  const int direction = std::fabs(arm.speed(i)) > moving_speed(i) ? sign_of(arm.speed(i)) : 0;
  if (direction != track.direction) {
    track.direction = direction;
    track.known_s = 0.0;
  }
  track.known_s += dt;
  const bool apart = crosses_gap(i, dt);
  if (arm.angle(i) > joint.stops.max - limits_.stop_rad || arm.angle(i) < joint.stops.min + limits_.stop_rad)
    return Sight::at_stop;
  if (direction == 0) return Sight::resting;
  if (apart) return Sight::in_gap;
  return track.known_s < limits_.settle_s || begun_s_ < limits_.begin_s ? Sight::turning : Sight::told;
}

double Ensemble::moving_speed(std::size_t i) const {
  const double noise = std::sqrt(noise_[i] * kSpeedNoise / cubed(limits_.filter_s));
  return std::max(limits_.moving_rad_s, limits_.moving_spreads * noise);
}

// Follows the motor through its gap, as seen from the joint: it lets go where it would have to pull.
bool Ensemble::crosses_gap(std::size_t i, double dt) {
  const Observer& arm = arms_[0];
  const arm::Joint<double>& joint = arm.row().plant.joints[i];
  Track& track = tracks_[i];
  const double passed = arm.passed(i), gap = 2.0 * joint.gear.half_gap;
  if (gap <= 0.0) return false;
  const bool loaded = std::fabs(passed) >= limits_.loaded_share * arm.stall(i);
  if (track.side == 0) track.side = passed < 0.0 ? -1 : 1;
  if (track.apart_rad <= 0.0 && track.side * passed >= 0.0) return !loaded;
  track.apart_rad_s -= track.side * passed / joint.actuator.inertia * dt;
  track.apart_rad += track.apart_rad_s * dt;
  if (track.apart_rad > 0.0 && track.apart_rad < gap) return true;
  if (track.apart_rad >= gap) {
    track.side = -track.side;
    track.known_s = 0.0;  // it strikes
  }
  track.apart_rad = track.apart_rad_s = 0.0;
  return !loaded;
}

double Ensemble::own_deviation(const Observer& arm, std::size_t i) const {
  const double noise =
      std::sqrt(noise_[i] * kTorqueNoise / (cubed(limits_.filter_s) * squared(limits_.filter_s))) * arm.inertia(i);
  return std::sqrt(squared(noise) + squared(limits_.friction_share * arm.friction(i)) +
                   squared(limits_.drive_share * arm.stall(i)));
}

double Ensemble::known_width(std::size_t i) const {
  const Observer& likeliest = arms_[0];
  double spread = 0.0;
  for (const Observer& arm : arms_) spread += squared(arm.torque(i) - likeliest.torque(i));
  spread /= static_cast<double>(std::max<std::size_t>(arms_.size() - 1, 1));
  // Beside a heavy motor light links hardly show how much a volt pushes.
  const double scale = limits_.scale_share * likeliest.torque(i) * likeliest.inertia(i) / likeliest.link_inertia(i);
  return limits_.interval * std::sqrt(spread + squared(own_deviation(likeliest, i)) + squared(scale));
}

// A contact is what nearly all arms take for one, each by its own doubts: a scale that is not known hides none.
bool Ensemble::touches(std::size_t i, bool told) const {
  double ups = 0.0, downs = 0.0;
  for (const Observer& arm : arms_) {
    const double least = limits_.contact_deviations * own_deviation(arm, i) + (told ? 0.0 : arm.held(i)) +
                         limits_.contact_share * arm.stall(i);
    ups += arm.torque(i) > least ? 1.0 : 0.0;
    downs += arm.torque(i) < -least ? 1.0 : 0.0;
  }
  return std::max(ups, downs) >= limits_.contact_arms * static_cast<double>(arms_.size());
}

bool Ensemble::is_slow(std::size_t i) const {
  return std::fabs(arms_[0].speed(i)) <= limits_.slow_spreads * moving_speed(i);
}

// A joint that turns crosses the play of its potentiometer unseen, by its motor's torque that nothing seems to take.
// Then the reading catches up at once, as if the same impulse came the other way.
bool Ensemble::may_be_play(std::size_t i, double dt, Sight sight) {
  const Observer& arm = arms_[0];
  Track& track = tracks_[i];
  const double play = 2.0 * limits_.play_share * arm.row().plant.joints[i].sensor.play;
  if (play <= 0.0) return false;
  const bool catches_up = sight == Sight::turning && arm.torque(i) * track.unseen_impulse < 0.0;
  if (!is_slow(i) && !catches_up) return false;
  track.unseen_impulse += arm.torque(i) * dt;
  if (catches_up) return true;
  track.unseen_rad_s += std::fabs(arm.torque(i)) / arm.inertia(i) * dt;
  track.unseen_rad += track.unseen_rad_s * dt;
  return track.unseen_rad < play;
}

void Ensemble::judge_contact(std::size_t i, double dt, Seen& seen) {
  Track& track = tracks_[i];
  const bool sighted = seen.sight != Sight::at_stop && seen.sight != Sight::unused;
  const bool touched = sighted && touches(i, seen.sight == Sight::told && !is_slow(i));
  if (!touched) track.unseen_rad = track.unseen_rad_s = 0.0;
  if (track.free_s >= limits_.settle_s) track.unseen_impulse = 0.0;
  track.beyond_s = touched && !may_be_play(i, dt, seen.sight) ? track.beyond_s + dt : 0.0;
  track.free_s = touched ? 0.0 : track.free_s + dt;
  const bool strikes = (seen.sight == Sight::in_gap || seen.sight == Sight::turning) && !is_slow(i) &&
                       arms_[0].row().plant.joints[i].gear.half_gap > 0.0;
  if (track.beyond_s >= (strikes ? limits_.strike_s : limits_.contact_s)) track.contact = true;
  if (track.free_s >= limits_.release_s) track.contact = false;
  seen.contact = track.contact;
}

}  // namespace greywhale::observe
