// Dry friction with true stiction: a shaft at rest stays exactly at rest until the breakaway torque is exceeded.
#pragma once

#include "parameters.h"
#include "scalar.h"

namespace greywhale::arm {

// Coulomb friction with the Stribeck excess in Hess and Soom's rational form: no exponential, and it is the breakaway
// torque at rest.
template <class T>
GREYWHALE_INLINE T friction_torque(const Friction<T>& friction, T velocity) {
  const T ratio = velocity / friction.stribeck_velocity;
  return friction.coulomb + (friction.breakaway - friction.coulomb) / (1.0 + ratio * ratio);
}

}  // namespace greywhale::arm
