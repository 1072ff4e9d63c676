// From a motor's data to what the joint feels of it, and from the commanded to the applied voltage.
#pragma once

#include <cmath>

#include "parameters.h"

namespace greywhale::arm {

// The physical equation, with N = gear_ratio:
//   U = [R/(N Kt)] [(A + N^2 J) q'' + C + G + N^2 Bm q'] + N Kt q'
inline Actuator<double> physical_actuator(const Motor& m) {
  const double joint_constant = m.gear_ratio * m.torque_constant;
  const double squared = m.gear_ratio * m.gear_ratio;
  return {joint_constant / m.resistance, squared * m.inertia,
          squared * m.viscous + joint_constant * joint_constant / m.resistance, m.resistance};
}

// What the paper's Eq. 1 must mean for its units to agree, with r = gear_ratio:
//   U = (R/Kt) [(A + J r) q'' + C + G] + (Kt r + Bm R/Kt) q'
inline Actuator<double> paper_actuator(const Motor& m) {
  const double torque_per_volt = m.torque_constant / m.resistance;
  return {torque_per_volt, m.inertia * m.gear_ratio, torque_per_volt * m.torque_constant * m.gear_ratio + m.viscous,
          m.resistance};
}

// The driver cannot exceed its supply and, when it has duty levels, gives only the nearest of them.
inline double applied_voltage(const Drive& drive, double volts) {
  const double limited = std::fmin(std::fmax(volts, -drive.supply.volts), drive.supply.volts);
  if (drive.pwm_levels == 0) return limited;
  const double step = drive.supply.volts / drive.pwm_levels;
  return step * std::round(limited / step);
}

}  // namespace greywhale::arm
