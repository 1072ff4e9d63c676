// See bench.h.
#include "bench.h"

#include <web/web_hal.h>

#include <algorithm>
#include <cmath>

namespace greywhale::web {
namespace {

constexpr double kSlice = 250e-6;      // s
constexpr double kEnough = 1.0;        // V at a motor: its current pulls a shared supply down
constexpr unsigned kSunkSlices = 120;  // 30 ms, until the board's regulator is back

// DRV8838: the enable input low, and between pulses, it shorts the motor.
double mean_share(const hal::web::MotorPins& pins) {
  if (!hal::web::drivers_on()) return 0.0;
  const double duty = static_cast<double>(pins.pwm) / hal::web::full_duty;
  return pins.direction ? duty : -duty;
}

}  // namespace

Bench::Bench(const Parameters& parameters, std::uint64_t seed)
    : person(Four{}),
      parameters_(parameters),
      arm_(parameters.arm, seed),
      leader_pots_(parameters.leader_pots, parameters.leader_pots_supply, seed),
      follower_pots_(parameters.follower_pots, parameters.follower_pots_supply, seed + 1),
      supply_(parameters.arm.drive.supply.volts) {
  place(Four{});
}

void Bench::run_slice() {
  drive();
  if (person.hold()) {
    place(*person.hold());
  } else {
    double volts[arm::kJoints];
    std::copy(voltages_.begin(), voltages_.end(), volts);
    arm_.step(volts, kSlice);
    std::copy(std::begin(arm_.state().q), std::end(arm_.state().q), follower_.begin());
  }
  person.step(hal::web::drivers_on(), follower_);
  if (!held_) {
    double angles[arm::kJoints], shown[arm::kJoints];
    std::copy(person.angles().begin(), person.angles().end(), angles);
    leader_pots_.millivolts(angles, shown);
    std::copy(std::begin(shown), std::end(shown), millivolts_.begin());
    std::copy(follower_.begin(), follower_.end(), angles);
    follower_pots_.millivolts(angles, shown);
    std::copy(std::begin(shown), std::end(shown), millivolts_.begin() + arm::kJoints);
    pot_faults.apply(millivolts_);
  }
  if (shared_) look_at_supply();
  board.run_slice(millivolts_, floating_, joined_);
}

void Bench::drive() {
  for (std::size_t joint = 0; joint < voltages_.size(); ++joint) {
    const auto driver = static_cast<std::uint8_t>(drivers_[joint]);
    voltages_[joint] = gains_[joint] * supply_ * mean_share(hal::web::motor_pins(driver));
  }
}

// No hand moves the follower beyond its stops.
void Bench::place(const Four& pose) {
  double angles[arm::kJoints];
  for (std::size_t joint = 0; joint < pose.size(); ++joint) {
    const arm::Stops<double>& stops = parameters_.arm.joints[joint].stops;
    follower_[joint] = angles[joint] = std::clamp(pose[joint], stops.min, stops.max);
  }
  arm_.reset(angles);
}

// Below 2.7 V the brown-out detector holds the chip in reset.
void Bench::look_at_supply() {
  if (sunk_) {
    if (--sunk_ == 0 && !board.powered()) board.power_on(hal::ResetCause::brown_out);
  } else if (std::any_of(voltages_.begin(), voltages_.end(), [](double volts) { return std::fabs(volts) > kEnough; })) {
    sunk_ = kSunkSlices;
    board.power_off();
  }
}

void Bench::set_wiring(std::size_t pot, arm::Wiring wiring) {
  (pot < arm::kJoints ? leader_pots_ : follower_pots_).set_wiring(pot % arm::kJoints, wiring);
}

void Bench::let_float(std::size_t pot, bool floats) {
  floating_ = floats ? floating_ | 1u << pot : floating_ & ~(1u << pot);
}

void Bench::touch(unsigned one, unsigned other) {
  pot_faults.touch(one, other);
  joined_ = 1u << one | 1u << other;
}

void Bench::wire_motor(std::size_t joint, double gain, std::size_t driver) {
  gains_.at(joint) = gain;
  drivers_.at(joint) = driver;
}

void Bench::load_tip(double mass) {
  parameters_.arm.tip_mass = mass;
  build_arm();
}

void Bench::scale_play(double times) {
  play_ = times;
  build_arm();
}

void Bench::build_arm() {
  arm::ArmParameters arm = parameters_.arm;
  for (arm::Joint<double>& joint : arm.joints) joint.gear.half_gap *= play_;
  arm_ = arm::Arm(arm, 0);
  place(follower_);
}

void Bench::scale_noise(double times) {
  for (std::size_t joint = 0; joint < arm::kJoints; ++joint) {
    leader_pots_.set_noise(joint, times * parameters_.leader_pots[joint].noise);
    follower_pots_.set_noise(joint, times * parameters_.follower_pots[joint].noise);
  }
}

void Bench::mend() {
  pot_faults = {};
  floating_ = joined_ = 0;
  for (std::size_t pot = 0; pot < kPots; ++pot) set_wiring(pot, arm::Wiring::connected);
  for (std::size_t joint = 0; joint < arm::kJoints; ++joint) wire_motor(joint, 1.0, joint);
  supply_ = parameters_.arm.drive.supply.volts;
  if (sunk_) board.power_on(hal::ResetCause::brown_out);
  sunk_ = 0;
  shared_ = false;
}

void Bench::hold_inputs(const Millivolts& millivolts) {
  held_ = true;
  millivolts_ = millivolts;
}

}  // namespace greywhale::web
