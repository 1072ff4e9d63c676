// A follower whose motion cannot be true, or is not what its motor was told: a potentiometer that lies, a motor or a
// potentiometer the wrong way round, a joint that is stuck or that somebody holds. Pure. It looks at one joint at a
// time, between ticks.
//
// speed:   the reading has moved faster than the limit. No joint does; a wiper, a wire or a converter does.
// runaway: the joint moves against its voltage for longer than the limit, and does not slow down. A joint that
//          overshoots is braked by such a voltage. So a way counts only as long as the speed is within a sixteenth of
//          the highest since the joint began to move against its voltage. A motor the wrong way round starts that
//          motion itself, from rest. Momentum, a neighbour's pull, a spring and a weight do not: there the joint is
//          fast already when the voltage comes to be against it. So the way may be twice the limit as long as the
//          speed is less than half as much again as it was then.
// held:    the voltage should have moved the joint, and the reading does not show it. A hand or a table may be in its
//          way, or the reading lies. Neither can be told from the other, so the joint is pushed gently for 64 ms, and
//          then held back: its motor gets no more than holds it against gravity, until the reading moves or the
//          reference comes back. From time to time the joint may try a little.
// stalled: held back for longer than the limit.
//
// How far a voltage moves a joint: V volts beyond those for gravity and friction give it V x speed_per_volt in the end.
// What has been given and has not been seen, as a way or as a speed that will still make a way, is missing. A reading
// comes late, so a joint that is given much may miss a little more before it is held back. A shoulder that speeds up
// throws the elbow back: by half of its own change, as the inertia of such arms has it (0.2 to 0.6, held straight).
//
// A joint that gives way while it is held back carries something that nobody has told of, and a reading that lies by
// standing still does not do that. What it carries counts as gravity from then on, up to 4 V.
#pragma once
#include <stdint.h>

namespace supervisor {

inline uint16_t size_of(int16_t value) {
  return value < 0 ? static_cast<uint16_t>(-static_cast<uint16_t>(value)) : static_cast<uint16_t>(value);
}

// The way of a look at a speed in rad/s, in q12 rad.
inline uint16_t way_of_look(uint8_t speed) { return static_cast<uint16_t>(speed * 131u / 8); }

// How far a voltage moves a joint; see motion.h.
struct Travel {
  uint8_t speed_per_volt;  // 1/32 rad/(s V)
  uint8_t time_constant;   // looks
  uint8_t breakaway;       // 0.1 V
};

struct MotionLimits {
  uint8_t speed;    // rad/s, 0 = no check
  uint8_t runaway;  // 1/128 rad, 0 = no check
  uint8_t stall;    // 0.1 V, the breakaway of a joint that has none; 0 = no joint is held back
  uint8_t time;     // 1/4 s, for which a joint may be held back
  Travel travel;
};

// What the last tick has seen of a joint, and what its motor was told.
struct JointSeen {
  int16_t follower, error;  // q12 rad
  int16_t volts_mv;
  int16_t gravity_mv;  // holds the joint against gravity where it is
};

enum class Hold : uint8_t {
  unknown,  // not looked at yet
  free,
  gentle,  // pushed gently at most
  back     // held back
};

enum class MotionFault : uint8_t { none, speed, runaway, stalled };

class Motion {
 public:
  static constexpr uint8_t joint_count = 4, elbow = 2;

  void forget() {
    for (Joint& joint : joints_) joint.hold = Hold::unknown;
  }
  // One look at a joint, the next joint in each tick.
  MotionFault look(uint8_t joint, const JointSeen& seen, const MotionLimits& limits) {
    if (joint != elbow) thrown_ = 0;
    return look_at(joints_[joint], seen, limits);
  }
  Hold hold(uint8_t joint) const { return joints_[joint].hold; }
  int16_t load_mv(uint8_t joint) const { return joints_[joint].load_mv; }
  // Whether the joint goes up, or down, faster than this.
  bool goes(uint8_t joint, bool up, int16_t than = moves) const {
    const int16_t speed = joints_[joint].speed;
    return up ? speed > than : speed < -than;
  }

  static constexpr int16_t fast = 64;  // q14 rad a look, 1 rad/s

 private:
  static constexpr int16_t moves = 20;  // q14 rad a look, 0.3 rad/s

  struct Joint {
    int16_t last;     // q12 rad, at the last look
    int16_t back;     // q12 rad, the way against the voltage, without a turn
    uint8_t peak;     // speed on that way, 1/1024 rad a look
    uint8_t brought;  // speed at its beginning
    Hold hold;
    int16_t place;    // q12 rad, the reading without its noise
    int16_t speed;    // q14 rad a look, of the place, smoothed
    int16_t missing;  // q14 rad, the way that the voltage has given, less that seen and that which the speed will make
    int16_t load_mv;  // carried beyond the gravity that is known
    uint16_t waited;  // looks held back
  };
  static_assert(sizeof(int) > 2 || sizeof(Joint) == 17, "a Nano's memory is short");
  struct Push {
    int16_t left_mv;     // beyond what gravity takes
    uint16_t starts_mv;  // breakaway
    int16_t way;         // q14 rad, given by this look in the end, in the direction of left_mv
  };

  MotionFault look_at(Joint& own, const JointSeen& seen, const MotionLimits& limits);
  static Push push_of(const JointSeen& seen, const MotionLimits& limits);
  static bool goes_back(Joint& joint, int16_t moved, const Push& push);
  static bool runs_away(const Joint& joint, uint8_t limit);
  static int16_t follow(Joint& joint);
  static void learn(Joint& joint, const Push& push, int16_t way);
  void expect(Joint& joint, const Push& push, const Travel& travel, int16_t way, bool back);
  static MotionFault hold(Joint& joint, int16_t given, int16_t error, uint8_t time);

  Joint joints_[joint_count] = {};
  int16_t thrown_ = 0;  // q14 rad a look, by which the joint before has become faster; for the elbow only
};

}  // namespace supervisor
