// Potentiometers: see potentiometer.h.
#include "potentiometer.h"

#include <algorithm>
#include <cmath>

#include "elementary.h"

namespace greywhale::arm {

Potentiometers::Potentiometers(const std::array<Potentiometer, kJoints>& pots, double supply, std::uint64_t seed,
                               double interval)
    : pots_(pots), supply_(supply), noise_{Noise(seed, 0), Noise(seed, 1), Noise(seed, 2), Noise(seed, 3)} {
  for (std::size_t i = 0; i < kJoints; ++i) lags_[i] = lag_of(pots[i].sensor.lag, interval);
}

// Without noise, in V. Past its ends the wiper stays on the end contact.
double Potentiometers::wiper(std::size_t joint, double angle) const {
  constexpr double kTurn = 6.283185307179586;
  const Potentiometer& pot = pots_[joint];
  const double along = std::clamp(pot.direction * (angle - pot.centre) / pot.track + 0.5, 0.0, 1.0);
  if (pot.linearity == 0.0) return supply_ * along;
  // One sine period over the track: exact at both ends and at the centre, as a pot that was calibrated there.
  return supply_ * (along + pot.linearity * sine(kTurn * along));
}

void Potentiometers::millivolts(const double (&angles)[kJoints], double (&out)[kJoints]) {
  const std::uint64_t reading = readings_++;
  for (std::size_t i = 0; i < kJoints; ++i) {
    if (reading == 0) shown_[i] = {angles[i], angles[i]};
    follow(pots_[i].sensor, lags_[i], angles[i], shown_[i]);
    if (wiring_[i] == Wiring::connected) {
      const double volts =
          wiper(i, shown_[i].after) + (pots_[i].noise > 0.0 ? pots_[i].noise * noise_[i].gaussian(reading) : 0.0);
      out[i] = 1000.0 * std::clamp(volts, 0.0, supply_);
    } else {
      out[i] = wiring_[i] == Wiring::open ? 0.0 : 1000.0 * supply_;
    }
  }
}

void Potentiometers::counts(const double (&angles)[kJoints], int bits, double (&out)[kJoints]) {
  millivolts(angles, out);
  const double codes = std::ldexp(1.0, bits);
  for (double& value : out) value = std::min(std::floor(value / (1000.0 * supply_) * codes), codes - 1.0);
}

}  // namespace greywhale::arm
