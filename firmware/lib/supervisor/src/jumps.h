// A leader whose reading jumps: a loose wire or wiper, or an input that reads another pot. Pure.
//
// The leader has no voltage to be measured by, and a hand may be as fast as it likes. But it is not fast at once: from
// one look to the next, 4 ms, recorded hands have changed a joint's speed by 1.4 rad/s at most. A leader that is thrown
// 1.5 rad within 40 ms changes by 22. So a jump is a reading that moves faster than the limit, and whose speed has
// changed by more than the limit since the last look. One that hits something passes: it is slow afterwards.
#pragma once
#include <stdint.h>

#include "motion.h"

namespace supervisor {

class Jumps {
 public:
  // The next look at each joint only learns: the last one may have been by another calibration.
  void forget() { unknown_ = Motion::joint_count; }
  // One look at a joint, the next joint in each tick, motors on or off. `limit` is in rad/s, 0 = no check.
  bool look(uint8_t joint, int16_t leader, uint8_t limit) {
    Joint& own = joints_[joint];
    const int16_t way = between(own.last, leader);
    const uint16_t most = way_of_look(limit);
    const bool known = unknown_ == 0;
    if (!known) --unknown_;
    const bool jumped = known && limit != 0 && size_of(way) > most && size_of(between(own.way, way)) > most;
    own.last = leader;
    own.way = way;
    return jumped;
  }

 private:
  struct Joint {
    int16_t last;  // q12 rad, at the last look
    int16_t way;   // q12 rad, of the look before it
  };
  static int16_t between(int16_t from, int16_t to) {
    return static_cast<int16_t>(static_cast<uint16_t>(to) - static_cast<uint16_t>(from));
  }

  Joint joints_[Motion::joint_count] = {};
  uint8_t unknown_ = 0;  // looks that only learn
};

}  // namespace supervisor
