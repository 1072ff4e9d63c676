// What arrives of a voltage at its motor: what is left of a supply with resistance while the motors draw current, less
// what the driver keeps.
#pragma once

#include "conditions.h"
#include "parameters.h"
#include "scalar.h"

namespace greywhale::arm {

// What is left of the nominal voltage, as a share, with motors at shares of full duty `duty` (negative backwards).
//
// A bridge at duty d takes d times its motor's current from the supply, and gives the motor d times what is left:
//   i = (d V - Ke w) / R,   V = V0 - Rs sum(d i),   Ke / R = torque per volt.
// A motor that brakes feeds the supply, as a battery allows. Motors by the paper's equation count as if geared 1 : 1.
template <class T>
GREYWHALE_INLINE T voltage_share(const Joint<T> (&joints)[kJoints], const Supply<T>& supply,
                                 const T (&motor_v)[kJoints], const T (&duty)[kJoints]) {
  T fed = constant<T>(0.0), load = constant<T>(0.0);
  for (std::size_t i = 0; i < kJoints; ++i) {
    fed = fed + duty[i] * joints[i].actuator.torque_per_volt * motor_v[i];
    load = load + duty[i] * duty[i] / joints[i].actuator.resistance;
  }
  const T one = constant<T>(1.0);
  const T left = (one + supply.resistance * fed / supply.volts) / (one + supply.resistance * load);
  return choose(left > constant<T>(0.0), left, constant<T>(0.0));
}

// The voltages that arrive at the motors of those that an unloaded supply would give.
template <class T>
void sag(const Joint<T> (&joints)[kJoints], const Supply<T>& supply, const State<T>& s, T (&volts)[kJoints]) {
  T duty[kJoints];
  for (std::size_t i = 0; i < kJoints; ++i) duty[i] = volts[i] / supply.volts;
  const T share = voltage_share(joints, supply, s.motor_v, duty);
  for (T& one : volts) one = one * share;
}

// The voltages that drivers pass on.
template <class T>
void lose(const Joint<T> (&joints)[kJoints], T (&volts)[kJoints]) {
  const T zero = constant<T>(0.0);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const T up = volts[i] - joints[i].driver.lost_up, down = volts[i] + joints[i].driver.lost_down;
    volts[i] = choose(up > zero, up, choose(down < zero, down, zero));
  }
}

template <class T>
bool has_losses(const Joint<T> (&joints)[kJoints]) {
  bool found = false;
  for (const Joint<T>& joint : joints) {
    found = found || any(joint.driver.lost_up > constant<T>(0.0)) || any(joint.driver.lost_down > constant<T>(0.0));
  }
  return found;
}

}  // namespace greywhale::arm
