// A follower whose motion cannot be true, or is not what its motor was told: a potentiometer that lies, a motor or a
// potentiometer the wrong way round, a joint that is stuck. Pure. It looks at one joint at a time, between ticks.
//
// speed:   the reading has moved faster than the limit. No joint does; a wiper, a wire or a converter does.
// runaway: the joint moves against its voltage for longer than the limit, and does not slow down. A joint that
//          overshoots is braked by such a voltage. So a way counts only as long as the speed is within a sixteenth of
//          the highest since the joint began to move against its voltage.
// stalled: the voltage has been above the limit for the time, and the reading has not left its place. Above half the
// supply time counts twice: the joint may be on its way, unseen, and is faster then. Time below the limit takes off
// three times as much, so that a voltage which dips now and then still counts.
#pragma once
#include <stdint.h>

namespace supervisor {

struct MotionLimits {
  uint8_t speed;    // rad/s, 0 = no check
  uint8_t runaway;  // 1/128 rad, 0 = no check
  uint8_t stall;    // 0.1 V, 0 = no check
  uint8_t time;     // 4 ms, of a stall
};

enum class MotionFault : uint8_t { none, speed, runaway, stalled };

class Motion {
 public:
  static constexpr uint8_t joint_count = 4;

  void forget() { known_ = 0; }
  // One look at a joint, the next joint in each tick: its follower in q12 rad, its voltage and the supply in mV.
  MotionFault look(uint8_t joint, int16_t follower, int16_t volts_mv, uint16_t supply_mv, const MotionLimits& limits);

 private:
  struct Joint {
    int16_t last;    // q12 rad, at the last look
    int16_t back;    // q12 rad, the way against the voltage, without a turn
    uint8_t peak;    // speed on that way, 1/1024 rad a look
    uint8_t place;   // 1/256 rad, where the stall began
    uint8_t stayed;  // there, in looks
  };
  static_assert(sizeof(int) > 2 || sizeof(Joint) == 7, "a Nano's memory is short");

  static bool runs_away(Joint& joint, int16_t moved, int16_t volts_mv, uint8_t limit);
  static bool is_stalled(Joint& joint, int16_t follower, uint16_t size_mv, uint16_t supply_mv,
                         const MotionLimits& limits);

  Joint joints_[joint_count] = {};
  uint8_t known_ = 0;  // bit i: joint i has been looked at
};

}  // namespace supervisor
