// The reference from a leader arm whose motion is scaled, smoothed or moved on by the clutch. It is computed between
// ticks, as the host's reference is; a tick sees leader angles only.
#pragma once
#include <link/schema.h>
#include <params/table.h>
#include <stdint.h>

#include "sampling.h"

namespace app {

class Scaling {
 public:
  constexpr Scaling() : asked_(false), disengaged_(false), shifted_(false), on_(false) {}

  // False while the leader's potentiometers are the reference, as they are.
  bool on() const { return on_; }
  // From the next advance() on the leader arm leads, by this set. The motors are off until then.
  void begin(const params::Table& table);

  void ask(bool disengage) { asked_ = disengage; }
  void reset();  // begin() must follow
  wire::Clutch clutch() const {
    if (asked_ || disengaged_) return wire::Clutch::disengaged;
    return shifted_ ? wire::Clutch::shifted : wire::Clutch::engaged;
  }

  // Once in each tick while the leader arm leads. False when there was nothing to do.
  bool advance(bool motors_on, bool pedal, const params::Table& table, Sampling& sampling);

 private:
  int16_t shift_q10_[hal::joint_count] = {};  // rad, from the leader's angle times the ratio
  bool asked_ : 1;                            // by the host, to be disengaged
  bool disengaged_ : 1;                       // as the last advance() has found it
  bool shifted_ : 1;
  bool on_ : 1;
};

}  // namespace app
