// An ideal controller of the arm: it knows the plant and its whole state exactly, and the leader up to this moment.
//
// Each joint runs at full voltage towards the leader until what is left is the way it needs to stop there at full
// voltage, times `brake` (1 is the fastest arrival; a little less gives the smallest squared error: Fuller's problem),
// and then follows that braking curve. Close to the leader the curve gives way to a straight line, so that it settles
// instead of chattering. Gravity, velocity terms, the other joints' pull and friction are compensated as far as the
// voltage goes. The motor's angle is controlled, with the gear's give allowed for: a law that looked at the link alone
// would throw it from side to side in its gap.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "arm/elementary.h"
#include "arm/step.h"

namespace greywhale::ideal {

using arm::kJoints;

// What is left open in a joint's law.
struct Tuning {
  double brake;   // share of the exact stopping distance at which braking begins
  double settle;  // s, time constant with which the last bit of error goes
  double lead;    // share of the leader's present speed that the follower takes for granted
  double pull;    // share of the other joints' pull that counts when braking begins
};

// How a joint slows down under full reverse voltage: v' = -(stop + damping v) / inertia.
struct Braking {
  double inertia, damping, stop;  // kg m^2, N m s, N m
};

// Way covered relative to a target of constant speed until the closing speed `w` is gone; `stop` includes the damping
// at the target's speed.
inline double stopping_distance(const Braking& b, double w) {
  const double ratio = b.damping * w / b.stop;
  if (ratio < 1e-4) return 0.5 * b.inertia * w * w / b.stop * (1.0 - 2.0 / 3.0 * ratio);
  return b.inertia / b.damping * (w - b.stop / b.damping * arm::logarithm_of_1_and(ratio));
}

// The closing speed whose stopping distance is `way`: Newton's method on a convex function, from the undamped solution.
inline double approach_speed(const Braking& b, double way) {
  if (way <= 0.0) return 0.0;
  double w = std::sqrt(2.0 * b.stop * way / b.inertia);
  for (int n = 0; n < 8; ++n) {
    const double slope = b.inertia * w / (b.stop + b.damping * w);
    const double change = (stopping_distance(b, w) - way) / slope;
    w -= change;
    if (std::fabs(change) < 1e-9 * w) break;
  }
  return w;
}

class Law {
 public:
  // Lets four tunings and the plant live outside; called every `dt` seconds.
  Law(const arm::Plant<double>& plant, double supply, const Tuning* tuning, double dt)
      : plant_(plant), supply_(supply), tuning_(tuning), dt_(dt) {}

  // Voltages (V) for the next slice, from the state now and the leader's angles and speeds (rad, rad/s).
  void volts(const arm::State<double>& s, const double (&leader)[kJoints], const double (&speed)[kJoints],
             double (&u)[kJoints]) {
    const arm::Geometry<double> geometry = arm::geometry_of(plant_.body, arm::pose_of<double>(s.q[1], s.q[2]));
    const arm::MassMatrix<double>& m = geometry.mass;
    double bias[kJoints];
    arm::bias_torque(geometry, s.v, bias);
    watch(s);
    const double own[kJoints] = {m.m00, m.m11, m.m22, m.m33};
    const double pulled[kJoints] = {m.m03 * pace_[3], m.m12 * pace_[2], m.m12 * pace_[1], m.m03 * pace_[0]};
    for (std::size_t i = 0; i < kJoints; ++i) {
      const arm::Joint<double>& joint = plant_.joints[i];
      const Tuning& tuning = tuning_[i];
      u[i] = 0.0;
      if (!arm::has_room(joint.stops)) continue;  // it is not in use
      learn(joint.gear, leader[i] - s.q[i], give_[i]);
      const double error = leader[i] + give(joint, bias[i]) + give_[i] - s.motor_q[i];
      const double inertia = own[i] + joint.actuator.inertia;
      const double wanted =
          wanted_speed(joint, inertia, bias[i] + tuning.pull * pulled[i], error, tuning.lead * speed[i], tuning);
      const double hurry = inertia * (wanted - s.motor_v[i]) / (kSpeedShare * tuning.settle);
      const double dry = arm::friction_torque(joint.friction, s.motor_v[i]) * std::clamp(wanted / kDrySpeed, -1.0, 1.0);
      const double torque = hurry + joint.actuator.damping * wanted + dry + bias[i] + pulled[i];
      u[i] = std::clamp(torque / joint.actuator.torque_per_volt, -supply_, supply_);
    }
  }

 private:
  static constexpr double kSpeedShare = 0.3;  // the speed follows this much faster than the angle
  static constexpr double kDrySpeed = 0.02;   // rad/s from which on all dry friction is compensated
  static constexpr double kLeastShare =
      0.02;  // of the full torque: left for braking whatever the load; presses the teeth together
  static constexpr double kLearning = 0.1;    // s
  static constexpr double kSmoothing = 5e-3;  // s, of the links' accelerations: their teeth ring

  void watch(const arm::State<double>& s) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      pace_[i] += dt_ / kSmoothing * ((s.v[i] - last_v_[i]) / dt_ - pace_[i]);
      last_v_[i] = s.v[i];
    }
  }

  // The speed at which the joint can still stop at the leader, or at which the last bit of error goes.
  double wanted_speed(const arm::Joint<double>& joint, double inertia, double load, double error, double lead,
                      const Tuning& t) const {
    const double side = error < 0.0 ? -1.0 : 1.0;
    const double full = joint.actuator.torque_per_volt * supply_;
    const double stop = full + joint.friction.coulomb + side * (load + joint.actuator.damping * lead);
    const Braking braking{inertia, joint.actuator.damping, std::max(stop, kLeastShare * full)};
    const double way = std::fabs(error), settling = way / t.settle;
    const bool near = stopping_distance(braking, settling) * t.brake <= way;
    return lead + side * (near ? settling : approach_speed(braking, way / t.brake));
  }

  // How far the motor stands ahead of a link that hangs in its teeth with this torque.
  double give(const arm::Joint<double>& joint, double torque) const {
    const arm::Gear<double>& gear = joint.gear;
    if (!(gear.stiffness > 0.0)) return 0.0;
    const double pressed = std::clamp(torque / (kLeastShare * joint.actuator.torque_per_volt * supply_), -1.0, 1.0);
    return pressed * gear.half_gap + torque / gear.stiffness;
  }

  // What `give` is off, found slowly from the link's angle once it is near.
  void learn(const arm::Gear<double>& gear, double link_error, double& correction) const {
    const double most = 2.0 * gear.half_gap;
    if (std::fabs(link_error) < 2.0 * most)
      correction = std::clamp(correction + dt_ / kLearning * link_error, -most, most);
  }

  const arm::Plant<double>& plant_;
  const double supply_;
  const Tuning* tuning_;
  const double dt_;
  double give_[kJoints] = {};
  double pace_[kJoints] = {};  // rad/s^2
  double last_v_[kJoints] = {};
};

}  // namespace greywhale::ideal
