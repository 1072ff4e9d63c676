// External torques from angles and voltages alone: a generalised-momentum observer with the plant's own equations.
//
// What changes a joint's momentum and is neither motor, gravity, other links nor friction pushes from outside
// (De Luca and Mattone 2003, in the form that needs no acceleration):
//   p = M(q) v + J v,   r = K (p - integral(torque - D v - friction - gravity + dT/dq + r)).
// Angles and motor torques go through the same low-passes, so that r is the outside torque behind four of them.
// Friction is known while a joint moves and not while it rests (Linderoth et al. 2013); a motor in its gap tells
// nothing. So every value comes with half the width of its interval and with what can be told.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "closed_loop/experiment.h"
#include "score/limits.h"

namespace greywhale::observe {

constexpr std::size_t kJoints = arm::kJoints;
using Four = double[kJoints];

enum class Sight : std::uint8_t {
  told,
  turning,  // just began to move, turned or struck: play and gap are not crossed, or the filters still settle
  resting,  // friction holds up to the breakaway torque
  in_gap,   // the motor does not touch its joint
  at_stop,
  unused,
};

using Limits = score::TorqueLimits;

struct Seen {
  double torque;      // N m, positive in the direction of the joint
  double half_width;  // N m
  Sight sight;
  bool contact;
};

// A first-order low-pass.
struct Lag {
  double value = 0.0;
  void follow(double target, double share) { value += (target - value) * share; }
};

// One arm that could have made the samples.
class Observer {
 public:
  explicit Observer(const loop::PlantRow& row) : row_(row) {}
  // At rest at these angles (rad), with nothing known of the motors.
  void start(const Four& angles);
  // dt seconds later, in which these voltages were commanded, the joints read these angles.
  void step(double dt, const Four& angles, const Four& volts, double filter_s, double delay_s);

  const loop::PlantRow& row() const { return row_; }
  double torque(std::size_t i) const { return residual_[i]; }
  double speed(std::size_t i) const { return speed_[i]; }
  double angle(std::size_t i) const { return second_[i].value; }
  double inertia(std::size_t i) const { return inertia_[i]; }            // of all that turns with the joint
  double link_inertia(std::size_t i) const { return link_inertia_[i]; }  // of the links alone
  // What a motor that goes with its joint passes on, and the friction that takes its share of it, N m.
  double passed(std::size_t i) const { return passed_[i]; }
  double friction(std::size_t i) const { return friction_[i]; }
  double stall(std::size_t i) const;  // N m of the standing motor
  double held(std::size_t i) const;   // N m that friction may hold at rest

 private:
  void drive_motors(double dt, const Four& volts, double filter_s, double delay_s);

  loop::PlantRow row_;
  Lag first_[kJoints], second_[kJoints], slow_[kJoints];
  Lag delayed_[kJoints], half_driven_[kJoints], driven_[kJoints];
  Four speed_ = {}, acceleration_ = {}, integral_ = {}, residual_ = {}, passed_ = {}, friction_ = {}, inertia_ = {};
  Four link_inertia_ = {1.0, 1.0, 1.0, 1.0};
};

// All arms that could have made the samples, the likeliest first, and what they agree on.
class Ensemble {
 public:
  // `noise`: of an angle's reading, rad^2 s (variance times spacing). `delay_s`: by which angles are read late.
  Ensemble(const loop::PlantRow* rows, std::size_t count, const Limits& limits, const Four& noise, double delay_s);
  void restart() { fresh_ = true; }
  // A sample: the voltages are commanded from its time on.
  void step(double time_s, const Four& angles, const Four& volts, Seen (&seen)[kJoints]);

 private:
  struct Track {
    int direction = 0;     // of the last sure motion
    double known_s = 0.0;  // since when it goes on
    int side = 0;          // of the teeth that touch
    double apart_rad = 0.0, apart_rad_s = 0.0;
    double unseen_rad = 0.0, unseen_rad_s = 0.0;  // what the joint may have moved within its potentiometer's play
    double unseen_impulse = 0.0;                  // N m s, that nothing seemed to take
    double beyond_s = 0.0, free_s = 0.0;
    bool contact = false;
  };

  Sight look(std::size_t i, double dt);
  bool crosses_gap(std::size_t i, double dt);
  double moving_speed(std::size_t i) const;
  // N m, of noise and of doubts about friction and motor.
  double own_deviation(const Observer& arm, std::size_t i) const;
  double known_width(std::size_t i) const;  // half the interval's width where friction is known
  bool touches(std::size_t i, bool told) const;
  bool is_slow(std::size_t i) const;
  bool may_be_play(std::size_t i, double dt, Sight sight);
  void judge_contact(std::size_t i, double dt, Seen& seen);

  std::vector<Observer> arms_;
  Limits limits_;
  Four noise_;
  double delay_s_;
  Track tracks_[kJoints];
  Four volts_ = {};
  double time_s_ = 0.0, begun_s_ = 0.0;
  bool fresh_ = true;
};

}  // namespace greywhale::observe
