// What a potentiometer shows of its joint's angle: play between joint and wiper, then an analogue low-pass.
#pragma once

#include "parameters.h"
#include "scalar.h"

namespace greywhale::arm {

// Angles in rad.
template <class T>
struct Shown {
  T wiper;  // where the wiper stands: the joint drags it along at the ends of the play
  T after;  // behind the low-pass
};

// Exact for an angle that moves evenly over the step: what is left of an old difference after it, and the share of the
// step's movement that is not seen yet.
template <class T>
struct Lag {
  T kept, behind;
};

// With r = time constant / step, exp(-1/r) by its series in 1/r, which is right to 1e-4 for r above 1 and to 0.003
// below; without a lag both are exactly 0.
template <class T>
GREYWHALE_INLINE Lag<T> lag_of(T time_constant, T dt) {
  const T r = time_constant / dt;
  const T one = constant<T>(1.0);
  const T terms = (((((r + one) * r + 0.5) * r + 1.0 / 6.0) * r + 1.0 / 24.0) * r + 1.0 / 120.0) * r + 1.0 / 720.0;
  const T power = r * r * r;
  const T kept = power * power / terms;
  return {kept, r * (one - kept)};
}

template <class T>
GREYWHALE_INLINE void follow(const Sensor<T>& sensor, const Lag<T>& lag, T angle, Shown<T>& shown) {
  const T before = shown.wiper;
  const T low = angle - sensor.play, high = angle + sensor.play;
  shown.wiper = choose(before < low, low, choose(before > high, high, before));
  shown.after = shown.wiper - (shown.wiper - before) * lag.behind + (shown.after - before) * lag.kept;
}

}  // namespace greywhale::arm
