// The bench's own follower arm, with what people do to it: loads, pushes, obstacles, wear. A change builds it anew
// where it is, at rest.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "arm/arm.h"
#include "seams.h"

namespace greywhale::bench {

class OwnArm : public Plant {
 public:
  using Stops = std::array<arm::Stops<double>, arm::kJoints>;

  OwnArm(const arm::ArmParameters& parameters, std::uint64_t seed) : parameters_(parameters), arm_(parameters, seed) {
    for (std::size_t joint = 0; joint < stops_.size(); ++joint) stops_[joint] = parameters.joints[joint].stops;
  }

  void step(const Four& volts, double dt, Four& angles) override;
  // No hand moves it beyond its stops.
  bool place(Four& angles) override;
  Four motor_velocities() override;

  // Becomes another arm where this one is.
  void become(const arm::ArmParameters& parameters);
  void load_tip(double mass);                   // kg
  void scale_play(double times);                // of the gears, times their own
  void push(std::size_t joint, double torque);  // N m, from now on
  // Puts something hard in a joint's way (rad), on the side of it where it is not; none takes it away.
  void obstruct(std::size_t joint, std::optional<double> angle);

  double tip_mass() const { return parameters_.tip_mass; }
  const Stops& stops() const { return stops_; }
  arm::Arm& arm() { return arm_; }

 private:
  void build();

  arm::ArmParameters parameters_;
  arm::Arm arm_;
  Stops stops_;  // with the obstacles
  double play_ = 1.0;
  double pushes_[arm::kJoints] = {};
};

}  // namespace greywhale::bench
