// See bench.h.
#include "bench.h"

#include <cmath>
#include <utility>

namespace greywhale::bench {
namespace {

constexpr std::size_t kEnable = 0, kDuty = 1, kDirection = 5, kSecondDuty = 9, kSecondDirection = 13;  // among the pins

}  // namespace

Bench::Bench(BoardSeam& board, const Wiring& wiring, Person& person, Plant& plant, OwnArm* own, const Pots& pots,
             std::uint64_t seed, const Electrics& electrics)
    : board_(board),
      wiring_(wiring),
      person_(person),
      plant_(plant),
      own_(own),
      own_pots_(pots),
      leader_pots_(pots.leader, pots.leader_supply, seed),
      follower_pots_(pots.follower, pots.follower_supply, seed + 1),
      electrics_(electrics),
      own_supply_(electrics.supply),
      angles_(person.home()) {
  for (std::size_t joint = 0; joint < gains_.size(); ++joint) gains_[joint] = in_use(joint) ? 1.0 : 0.0;
  if (electrics.in_use != Person::kAllJoints) connect_all();
  place(person.home());
}

bool Bench::run_slices(std::uint64_t count) {
  std::uint64_t target = board_.cycle() / kSliceCycles * kSliceCycles;
  for (; count; --count) {
    target += kSliceCycles;
    run_slice();
    if (!board_.run_until(target)) return false;
    if (trace_) trace_(target, pins_);
  }
  return true;
}

void Bench::run_slice() {
  Pins pins{};
  board_.read_pins(pins);
  if (rewired_ || pins != pins_) {
    pins_ = pins;
    drive();
  }
  if (coasts_) coast();
  if (person_.hold) place(*person_.hold);
  else plant_.step(voltages_, kSlice, angles_);
  person_.step(enabled_, angles_);
  show_pots();
  board_.set_millivolts(millivolts_);
  if (shared_supply_) shared_supply_->look(voltages_);
}

// What the drivers' chips make of the pins: voltages, or motors that coast between pulses.
void Bench::drive() {
  rewired_ = coasts_ = false;
  enabled_ = pins_[kEnable] != 0.0;
  Four duties{};
  bool driven = enabled_;
  for (std::size_t driver = 0; driver < bridges_.size(); ++driver) {
    bridges_[driver] =
        bridge_of(electrics_.chip, {enabled_, pins_[kDuty + driver], pins_[kDirection + driver] != 0.0,
                                    pins_[kSecondDuty + driver], pins_[kSecondDirection + driver] != 0.0});
    duties[driver] = bridges_[driver].duty();
    driven = driven || duties[driver] != 0.0;
    coasts_ = coasts_ || bridges_[driver].open() != 0.0;
  }
  seen_.look(board_.cycle(), driven, duties);
  for (std::size_t joint = 0; joint < voltages_.size(); ++joint)
    voltages_[joint] = gains_[joint] * electrics_.supply * bridges_[drivers_[joint]].drive();
}

// The voltages of motors whose bridges are open for a while depend on how fast these motors turn.
void Bench::coast() {
  const Four speeds = plant_.motor_velocities();
  for (std::size_t joint = 0; joint < voltages_.size(); ++joint) {
    const Bridge& bridge = bridges_[drivers_[joint]];
    if (!(bridge.open() > 0.0)) continue;
    const double way = std::copysign(1.0, gains_[joint]), emf = electrics_.emf[joint] * speeds[joint];
    voltages_[joint] = way * mean_volts(bridge, std::fabs(gains_[joint]) * electrics_.supply, way * emf);
  }
}

void Bench::show_pots() {
  double angles[arm::kJoints], shown[arm::kJoints];
  std::copy(person_.angles().begin(), person_.angles().end(), angles);
  leader_pots_.millivolts(angles, shown);
  std::copy(std::begin(shown), std::end(shown), millivolts_.begin());
  std::copy(angles_.begin(), angles_.end(), angles);
  follower_pots_.millivolts(angles, shown);
  std::copy(std::begin(shown), std::end(shown), millivolts_.begin() + arm::kJoints);
  pot_faults_.apply(millivolts_);
}

void Bench::place(const Four& pose) {
  Four angles = pose;
  if (plant_.place(angles)) angles_ = angles;
}

void Bench::touch(std::size_t one, std::size_t other) {
  pot_faults_.touch(one, other);
  board_.set_joined(1u << one | 1u << other, 2);
}

void Bench::set_wiring(std::size_t pot, arm::Wiring wiring) { bank(pot).set_wiring(pot % arm::kJoints, wiring); }

void Bench::let_float(std::size_t pot, bool floats) {
  const unsigned bit = 1u << pot;
  floating_ = floats || !in_use(pot % arm::kJoints) ? floating_ | bit : floating_ & ~bit;
  board_.set_floating(floating_);
}

void Bench::wire_motor(std::size_t joint, double gain, std::size_t driver) {
  gains_.at(joint) = in_use(joint) ? gain : 0.0;
  drivers_.at(joint) = driver;
  rewired_ = true;
}

void Bench::change_supply(double volts) {
  electrics_.supply = volts;
  rewired_ = true;
}

void Bench::connect_all() {
  for (std::size_t joint = 0; joint < gains_.size(); ++joint) {
    wire_motor(joint, 1.0, joint);
    let_float(joint, false);
    let_float(joint + arm::kJoints, false);
  }
}

void Bench::mend() {
  pot_faults_ = {};
  board_.set_joined(0, 1);
  for (std::size_t pot = 0; pot < arm::kPots; ++pot) set_wiring(pot, arm::Wiring::connected);
  connect_all();
  change_supply(own_supply_);
  if (shared_supply_) shared_supply_->mend();
  shared_supply_.reset();
}

void Bench::scale_noise(double times) {
  for (std::size_t joint = 0; joint < arm::kJoints; ++joint) {
    leader_pots_.set_noise(joint, times * own_pots_.leader[joint].noise);
    follower_pots_.set_noise(joint, times * own_pots_.follower[joint].noise);
  }
}

void Bench::press_estop(bool pressed) {
  ground(wiring_.estop, pressed);
  estop_pressed_ = pressed;
}

void Bench::press_clutch(bool pressed) {
  ground(wiring_.clutch, pressed);
  clutch_pressed_ = pressed;
}

void Bench::ground(Pin pin, bool closed) {
  if (closed) board_.hold_low(pin);
  else board_.let_go(pin);
}

PinsSeen Bench::take_pins_seen() { return std::exchange(seen_, PinsSeen{}); }

}  // namespace greywhale::bench
