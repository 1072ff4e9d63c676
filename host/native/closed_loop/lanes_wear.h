// What stands between the arm and its board, in lanes: potentiometers with play and lag (sim/arm/sensor.h), a supply
// that sags and drivers that keep a part of their voltage (sim/arm/supply.h).
#pragma once

#include <cstddef>

#include "experiment.h"

namespace greywhale::loop::GREYWHALE_INSTRUCTIONS {

struct Sensors {
  bool on;                                              // whether any joint has play or lag
  Float play[kJoints], kept[kJoints], behind[kJoints];  // counts, and the shares of Lag
  Float wiper[kJoints], after[kJoints];                 // counts
};

GREYWHALE_INLINE void begin(Sensors& sensors, std::size_t i, Float place) {
  sensors.wiper[i] = sensors.after[i] = place;
}

// The place that the converter sees, of the joint's place a slice later than the one before.
GREYWHALE_INLINE Float follow(Sensors& s, std::size_t i, Float place) {
  const Float before = s.wiper[i];
  s.wiper[i] = greatest(least(before, place + s.play[i]), place - s.play[i]);
  s.after[i] = s.wiper[i] - (s.wiper[i] - before) * s.behind[i] + (s.after[i] - before) * s.kept[i];
  return s.after[i];
}

struct Sag {
  bool on;
  Float fed[kJoints], load[kJoints];  // per compare step and rad/s; per compare step squared
};

// The duties that would do at full supply what these do at what is left of it.
GREYWHALE_INLINE void sag(const Sag& sag, const State (&s)[kJoints], const Float (&duty)[kJoints],
                          Float (&arriving)[kJoints]) {
  Float fed = all(0.0f), load = all(0.0f);
  for (std::size_t i = 0; i < kJoints; ++i) {
    fed = fed + duty[i] * sag.fed[i] * s[i].motor_v;
    load = load + duty[i] * duty[i] * sag.load[i];
  }
  const Float left = greatest((all(1.0f) + fed) / (all(1.0f) + load), all(0.0f));
  for (std::size_t i = 0; i < kJoints; ++i) arriving[i] = duty[i] * left;
}

struct Losses {
  bool on;
  Float up[kJoints], down[kJoints];  // compare steps
};

// The duties that drivers pass on.
GREYWHALE_INLINE void lose(const Losses& losses, Float (&arriving)[kJoints]) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    arriving[i] = greatest(arriving[i] - losses.up[i], all(0.0f)) + least(arriving[i] + losses.down[i], all(0.0f));
  }
}

}  // namespace greywhale::loop::GREYWHALE_INSTRUCTIONS
