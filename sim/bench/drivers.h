// Motor drivers as their data sheets describe them: from the levels of their pins to what a motor's bridge does.
#pragma once

#include <cstdint>

namespace greywhale::bench {

// The pins that the board drives: duties 0..1, levels. One that it does not drive is low: chips pull it down.
struct DriverPins {
  bool enable;
  double pwm;      // or the first of two PWM inputs
  bool direction;  // or IN1
  double second_pwm;
  bool second_direction;  // IN2
};

// The share of a PWM period in which it puts the supply on a motor, either way, and in which it shorts the motor, so
// that it brakes. The rest of the time the bridge is open, and the motor coasts.
struct Bridge {
  double forwards, backwards, shorted;

  double open() const {
    const double rest = 1.0 - forwards - backwards - shorted;
    return rest > 0.0 ? rest : 0.0;
  }
  double drive() const { return forwards - backwards; }  // share of the supply on the motor, on the average
  double duty() const { return forwards > backwards ? forwards : backwards; }
};

// Sign and magnitude: PWM and direction, with an enable input. Half-bridges: a low input connects its side to ground.
enum class Chip : std::uint8_t {
  sign_magnitude,
  tb6612,
  l298n,
  two_inputs,
  two_inputs_nsleep,
  half_bridges,
  always_on
};

Bridge bridge_of(Chip chip, const DriverPins& pins);

// The voltage (V) that would drive the same mean current through a motor as this bridge does.
//
// With a bridge that is never open this is the mean voltage. In an open bridge the motor's inductance drives the
// current on, through diodes and against the supply, until it has died away; then no current flows.
double mean_volts(const Bridge& bridge, double supply, double emf);

}  // namespace greywhale::bench
