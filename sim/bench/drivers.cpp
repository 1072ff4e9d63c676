// See drivers.h.
#include "drivers.h"

#include <cmath>

#include "arm/elementary.h"

namespace greywhale::bench {
namespace {

constexpr double kPwm = 50e-6;  // s, a period
// s. Inductance over resistance of a small geared motor, some 1 mH and 3 ohm: how long a current lasts in an open
// bridge.
constexpr double kElectrical = 0.3e-3;
constexpr double kNeverOpen = 1e-9;

constexpr Bridge kOpen{0.0, 0.0, 0.0}, kShorted{0.0, 0.0, 1.0};

Bridge pulses(const DriverPins& pins, double shorted) {
  return pins.direction ? Bridge{pins.pwm, 0.0, shorted} : Bridge{0.0, pins.pwm, shorted};
}

// Between pulses it shorts the motor.
Bridge sign_magnitude(const DriverPins& pins) { return pins.enable ? pulses(pins, 1.0 - pins.pwm) : kShorted; }

Bridge tb6612(const DriverPins& pins) {
  if (!pins.enable) return kOpen;  // STBY
  if (pins.direction == pins.second_direction) return pins.direction ? kShorted : kOpen;
  return sign_magnitude(pins);
}

// The PWM is its enable input: between pulses all its switches are off.
Bridge l298n(const DriverPins& pins) {
  if (pins.direction == pins.second_direction) return {0.0, 0.0, pins.pwm};
  return pulses(pins, 0.0);
}

// Both inputs low opens the bridge, both high shorts it. Pulses of two timers meet by chance.
Bridge two_inputs(const DriverPins& pins) {
  const double first = pins.pwm, second = pins.second_pwm;
  return {first * (1.0 - second), second * (1.0 - first), first * second};
}

Bridge half_bridges(const DriverPins& pins) {
  const Bridge bridge = two_inputs(pins);
  return {bridge.forwards, bridge.backwards, bridge.shorted + bridge.open()};
}

// 1 - exp(-x) up to kPwm / kElectrical by its series, which has the same bits with every C library.
double risen(double x) {
  double rest = 1.0;
  for (int n = 12; n > 1; --n) rest = 1.0 - x / n * rest;
  return x * rest;
}

// The mean for pulses one way and an open bridge between them; `emf` counts in the way of the pulses.
double pulsed(double duty, double supply, double emf) {
  const double on = duty * kPwm;
  const double peak = (supply - emf) * risen(on / kElectrical);  // of the current, times the resistance
  const double against = std::copysign(supply, peak);
  const double final = -against - emf;  // what an endless pause would lead to
  if (peak * final >= 0.0) return duty * supply - (1.0 - duty) * against;
  const double fall = kElectrical * arm::logarithm((peak - final) / -final);
  if (fall >= kPwm - on) return duty * supply - (1.0 - duty) * against;  // the current never ends
  return emf + (supply * on - against * fall - emf * (on + fall)) / kPwm;
}

}  // namespace

Bridge bridge_of(Chip chip, const DriverPins& pins) {
  switch (chip) {
    case Chip::sign_magnitude: return sign_magnitude(pins);
    case Chip::tb6612: return tb6612(pins);
    case Chip::l298n: return l298n(pins);
    case Chip::two_inputs: return two_inputs(pins);
    case Chip::two_inputs_nsleep: return pins.enable ? two_inputs(pins) : kOpen;
    case Chip::half_bridges: return pins.enable ? half_bridges(pins) : kOpen;
    case Chip::always_on: return half_bridges(pins);
  }
  return kOpen;
}

double mean_volts(const Bridge& bridge, double supply, double emf) {
  if (bridge.open() < kNeverOpen) return supply * bridge.drive();
  const double driven = bridge.drive();
  if (driven == 0.0 || supply == 0.0) return emf * bridge.open();
  const double way = std::copysign(1.0, driven);
  return way * pulsed(std::fabs(driven), supply, way * emf);
}

}  // namespace greywhale::bench
