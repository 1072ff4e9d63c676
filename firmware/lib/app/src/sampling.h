// What the potentiometers say: owner of the signals, and what the parameters mean for them.
#pragma once
#include <hal.h>
#include <params/table.h>
#include <stdint.h>

#include "signals.h"

namespace app {

class Sampling {
 public:
  void configure(const params::Table& table);
  // Takes the sums of every pot, as hal::pot_sums() has them; notes rails and distances in `seen`.
  void tick(const uint16_t* sums, supervisor::Observation& seen);

  // The leader's angle, or what the host leads.
  int16_t leader(uint8_t joint) const { return signal_chain::angle(signals_.joint[joint].leader); }   // q12 rad
  int16_t follower(uint8_t joint) const { return signals_.joint[joint].follower_angle; }
  // From the follower to the leader within the joint's limits.
  int16_t error(uint8_t joint) const { return signals_.joint[joint].error; }
  int16_t within_limits(uint8_t joint, int16_t angle) const;
  // Between reference and follower, as it is now rather than when the last tick looked.
  uint16_t distance(uint8_t joint) const;

  // Puts a reference in a leader pot's place until configure() is called: a line of slope 0, so that a tick does what it always
  // does. move_lead() shifts it, in 2^-15 q12 rad.
  void lead(uint8_t joint, int16_t angle);
  void move_lead(uint8_t joint, int32_t by);

 private:
  Signals signals_ = {signal_chain::low_pass(0), 0, 0xffff, {}};   // takes the first sample whole
  uint8_t shift_ = 0;
  bool primed_ = false;
};

}  // namespace app
