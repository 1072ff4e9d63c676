// Four joint potentiometers: angle to wiper voltage, with noise, linearity error, broken wires, and a converter where
// one is wanted.
#pragma once

#include <array>
#include <cstdint>

#include "parameters.h"
#include "random.h"
#include "sensor.h"

namespace greywhale::arm {

struct Potentiometer {
  double track;      // rad, from one end of the resistance to the other
  double centre;     // rad, joint angle at mid-track
  double direction;  // +1 or -1: sign of the voltage's slope
  double noise;      // V rms at the wiper
  double linearity;  // largest deviation from the straight line, as a share of the full scale
  Sensor<double> sensor;
};

constexpr std::size_t kPots = 2 * kJoints;  // 0..3 leader, 4..7 follower
using Millivolts = std::array<double, kPots>;

// Connected; open: the wire is off and the input's pull-down wins; shorted: the wiper touches the supply.
enum class Wiring : std::uint8_t { connected, open, shorted };

class Potentiometers {
 public:
  static constexpr double kInterval = 0.25e-3;  // s between readings

  Potentiometers(const std::array<Potentiometer, kJoints>& pots, double supply, std::uint64_t seed,
                 double interval = kInterval);

  void set_wiring(std::size_t joint, Wiring wiring) { wiring_.at(joint) = wiring; }
  void set_noise(std::size_t joint, double rms) { pots_.at(joint).noise = rms; }  // V
  Wiring wiring(std::size_t joint) const { return wiring_.at(joint); }
  double shown(std::size_t joint) const { return shown_[joint].after; }  // rad, at the last reading, without noise

  // Voltages at the converter in mV, 0 to the supply. Each call is a reading, `interval` after the one before, and
  // draws new noise. At the first reading the wipers stand in the middle of their play, and nothing lags.
  void millivolts(const double (&angles)[kJoints], double (&out)[kJoints]);

  // The same through a converter of `bits` bits whose reference is the supply.
  void counts(const double (&angles)[kJoints], int bits, double (&out)[kJoints]);

 private:
  double wiper(std::size_t joint, double angle) const;

  std::array<Potentiometer, kJoints> pots_;
  std::array<Wiring, kJoints> wiring_{};
  double supply_;
  std::array<Noise, kJoints> noise_;
  std::array<Lag<double>, kJoints> lags_{};
  std::array<Shown<double>, kJoints> shown_{};
  std::uint64_t readings_ = 0;
};

}  // namespace greywhale::arm
