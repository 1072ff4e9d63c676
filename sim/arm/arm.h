// The follower arm as a thing with a state: four voltages in, four joint angles out.
#pragma once

#include <cstdint>

#include "parameters.h"
#include "random.h"
#include "rigid_body.h"
#include "step.h"

namespace greywhale::arm {

class Arm {
 public:
  static constexpr double kLongestStep = 0.25e-3;  // s

  // `seed` draws where in its backlash each gear stands after a reset. Throws std::invalid_argument for a bad
  // `longest_step`.
  Arm(const ArmParameters& parameters, std::uint64_t seed, double longest_step = kLongestStep);

  // Puts the links at rest at these angles (rad), within the stops.
  void reset(const double (&angles)[kJoints]);

  // Holds the voltages (V) for `dt` seconds, in equal steps of at most `longest_step`.
  // Throws std::invalid_argument and leaves the arm as it was for a voltage or time that is not usable.
  void step(const double (&volts)[kJoints], double dt);

  // Torques (N m) that something outside applies to the links from now on.
  void set_load(const double (&torques)[kJoints]);

  const State<double>& state() const { return state_; }
  const RigidBody<double>& body() const { return plant_.body; }
  double kinetic_energy() const;    // links and motors
  double potential_energy() const;  // gravity and teeth
  std::uint64_t steps() const { return steps_; }
  std::uint64_t unsettled_steps() const { return unsettled_; }

 private:
  Plant<double> plant_{};
  bool worn_, loses_;
  Drive drive_;
  Noise noise_;
  double longest_step_;
  State<double> state_{};
  double load_[kJoints] = {};
  std::uint64_t resets_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t unsettled_ = 0;
};

}  // namespace greywhale::arm
