// The arm as plain numbers in SI units. They are validated where they are read (host/src/greywhale/arm); here they are
// only used.
#pragma once

#include <array>
#include <cstddef>

namespace greywhale::arm {

constexpr std::size_t kJoints = 4;  // base yaw, shoulder pitch, wrist pitch, wrist roll

// Link x runs along the link, y is up at zero pitch, z is the pitch axis; inertias are about the centre of mass.
struct Link {
  double mass;           // kg
  double length;         // m
  double centre;         // m, centre of mass from the nearer joint
  double ixx, iyy, izz;  // kg m^2
};

// A geared DC motor with its data sheet's values; motor speed = gear_ratio x joint speed.
struct Motor {
  double inertia;          // J, kg m^2, at the motor shaft
  double resistance;       // R, ohm
  double torque_constant;  // Kt = Ke, N m/A
  double viscous;          // Bm, N m s, at the motor shaft
  double gear_ratio;       // N
};

// The three combinations of a motor's five values that the motion can reveal, seen from the joint's output shaft.
template <class T>
struct Actuator {
  T torque_per_volt;  // N m/V, at standstill
  T inertia;          // kg m^2, reflected
  T damping;          // N m s, back-EMF and viscous friction together
  T resistance;       // ohm, of winding and driver; matters only where the supply's voltage sags
};

// Dry friction of motor and gear train, as torque at the output shaft.
template <class T>
struct Friction {
  T coulomb;            // N m, sliding
  T breakaway;          // N m, at rest; >= coulomb
  T stribeck_velocity;  // rad/s, where the excess over Coulomb has halved
  T load;               // share of the torque that the teeth pass on, which adds to all of these; below 1
  T creep;              // rad/s at which a shaft under nearly the breakaway torque gives way; 0: not at all
};

// The gear mesh between motor side and link side. No gap and no stiffness: a rigid gear.
template <class T>
struct Gear {
  T half_gap;   // rad, at the output shaft
  T stiffness;  // N m/rad, of the teeth in contact
  T damping;    // N m s, of the teeth in contact
  T drag;       // N m s, of the grease, also with the teeth apart
};

// Without room between them they hold a joint that is not in use: it is rigid there, and its stop never lets go.
template <class T>
struct Stops {
  T min, max;  // rad
};

inline bool has_room(const Stops<double>& stops) { return stops.max > stops.min; }

// How a potentiometer follows its joint.
template <class T>
struct Sensor {
  T play;  // rad, half of the play between joint and wiper
  T lag;   // s, time constant of the low-pass between wiper and converter
};

// What a motor's driver keeps for itself of a voltage, as bridges do whose sides are never on together. A smaller
// voltage does nothing.
template <class T>
struct Driver {
  T lost_up, lost_down;  // V, of voltages above and below 0
};

template <class T>
struct Joint {
  Actuator<T> actuator;
  Friction<T> friction;
  Gear<T> gear;
  Stops<T> stops;
  Sensor<T> sensor;
  Driver<T> driver;
};

// What feeds all motor drivers.
template <class T>
struct Supply {
  T volts;       // V without load, which is also full duty
  T resistance;  // ohm, of battery and cables, shared by all motors
};

struct Drive {
  Supply<double> supply;
  int pwm_levels;  // duty steps from 0 to full; 0: not quantised
};

struct ArmParameters {
  std::array<Link, kJoints> links;
  double tip_mass;  // kg, carried at the end of link 3
  double gravity;   // m/s^2
  std::array<Joint<double>, kJoints> joints;
  Drive drive;
};

}  // namespace greywhale::arm
