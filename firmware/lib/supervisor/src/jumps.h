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
  void forget() {
    for (Joint& joint : joints_) joint.known = false;
  }
  // One look at the joint whose turn is in this tick, motors on or off. The link may leave no time for a look: the next
  // one then sees the way of 8 ms, or, after more, only learns. `limit` is in rad/s, 0 = no check.
  bool look(uint16_t tick, int16_t leader, uint8_t limit) {
    Joint& own = joints_[tick % Motion::joint_count];
    const auto passed = static_cast<uint16_t>(tick - own.tick);
    int16_t way = between(own.last, leader);
    if (passed == 2 * Motion::joint_count) way = static_cast<int16_t>(way / 2);
    const bool known = own.known && passed <= 2 * Motion::joint_count;
    const uint16_t most = way_of_look(limit);
    const bool jumped = known && limit != 0 && size_of(way) > most && size_of(between(own.way, way)) > most;
    own = {leader, way, tick, true};
    return jumped;
  }

 private:
  struct Joint {
    int16_t last;   // q12 rad, at the last look
    int16_t way;    // q12 rad within 4 ms, until then
    uint16_t tick;  // of the last look
    bool known;
  };
  static int16_t between(int16_t from, int16_t to) {
    return static_cast<int16_t>(static_cast<uint16_t>(to) - static_cast<uint16_t>(from));
  }

  Joint joints_[Motion::joint_count] = {};
};

}  // namespace supervisor
