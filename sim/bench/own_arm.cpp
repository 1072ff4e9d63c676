// See own_arm.h.
#include "own_arm.h"

#include <algorithm>

namespace greywhale::bench {
namespace {

constexpr std::uint64_t kRebuilt = 0;  // the seed of an arm that is built anew

Four four(const double (&values)[arm::kJoints]) {
  Four copy;
  std::copy(std::begin(values), std::end(values), copy.begin());
  return copy;
}

}  // namespace

void OwnArm::step(const Four& volts, double dt, Four& angles) {
  double held[arm::kJoints];
  std::copy(volts.begin(), volts.end(), held);
  arm_.step(held, dt);
  angles = four(arm_.state().q);
}

bool OwnArm::place(Four& angles) {
  double within[arm::kJoints];
  for (std::size_t joint = 0; joint < angles.size(); ++joint)
    within[joint] = angles[joint] = std::clamp(angles[joint], stops_[joint].min, stops_[joint].max);
  arm_.reset(within);
  return true;
}

Four OwnArm::motor_velocities() { return four(arm_.state().motor_v); }

void OwnArm::become(const arm::ArmParameters& parameters) {
  parameters_ = parameters;
  for (std::size_t joint = 0; joint < stops_.size(); ++joint) stops_[joint] = parameters.joints[joint].stops;
  build();
}

void OwnArm::load_tip(double mass) {
  parameters_.tip_mass = mass;
  build();
}

void OwnArm::scale_play(double times) {
  play_ = times;
  build();
}

void OwnArm::push(std::size_t joint, double torque) {
  pushes_[joint] = torque;
  arm_.set_load(pushes_);
}

void OwnArm::obstruct(std::size_t joint, std::optional<double> angle) {
  arm::Stops<double> stops = parameters_.joints.at(joint).stops;
  if (angle && stops.min < *angle && *angle < stops.max)
    (*angle > arm_.state().q[joint] ? stops.max : stops.min) = *angle;
  stops_[joint] = stops;
  build();
}

void OwnArm::build() {
  arm::ArmParameters parameters = parameters_;
  for (std::size_t joint = 0; joint < stops_.size(); ++joint) {
    parameters.joints[joint].gear.half_gap *= play_;
    parameters.joints[joint].stops = stops_[joint];
  }
  Four angles = four(arm_.state().q);
  arm_ = arm::Arm(parameters, kRebuilt);
  place(angles);
  arm_.set_load(pushes_);
}

}  // namespace greywhale::bench
