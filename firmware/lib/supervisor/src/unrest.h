// A joint that hunts: its error swings to and fro although nobody moves the leader, and the swings do not die away.
// Pure. It looks at one joint at a time, between ticks, because a tick has no time to spare.
//
// The error turns when it has come back from its farthest point by more than twice the amplitude. Time is cut into
// slots of 1/rate. A joint is restless when its error has turned in every slot for longer than the limit's time. That
// time starts anew
// - when a joint of the leader has moved by more than the amplitude within a slot: the error may be the leader's doing;
// - when the largest swing of a slot is less than half of the largest one before it: a step rings down, hunting goes
// on.
#pragma once
#include <stdint.h>

namespace supervisor {

struct UnrestLimits {
  uint8_t amplitude;  // 1/1024 rad, 0 = no check
  uint8_t rate;       // 1/s, 1..10
  uint8_t time;       // 0.1 s, at most 60
};

class Unrest {
 public:
  static constexpr uint8_t joint_count = 4;

  void configure(const UnrestLimits& limits);
  void forget();
  // Somebody or something holds this joint: what swings is not its controller's doing.
  void forget(uint8_t joint);
  // One look at a joint, the next joint in each tick. Reference and error are in q12 rad. True when it is restless.
  bool look(uint8_t joint, int16_t reference, int16_t error);
  // Whether it has swung for some slots, though not yet for long enough.
  bool swings(uint8_t joint) const { return joints_[joint].slots >= some_slots; }

 private:
  struct Joint {
    int16_t leader;     // at the beginning of the slot
    int16_t farthest;   // error of this swing
    uint8_t turn;       // where this swing began; this and the next two in 1/256 rad, a rad and more are taken for less
    uint8_t largest;    // swing that has ended in this slot, 0 = no turn
    uint8_t before;     // the largest swing of the slots before
    bool rising : 1;    // the error
    uint8_t slots : 7;  // in a row with a turn
  };
  static_assert(sizeof(int) > 2 || sizeof(Joint) == 8, "a Nano's memory is short");
  static constexpr uint8_t looks_per_second = 250;  // at a joint
  static constexpr uint8_t some_slots = 2;

  void follow(Joint& joint, int16_t error) const;
  static void end_slot(Joint& joint);

  Joint joints_[joint_count] = {};
  uint8_t amplitude_ = 0;
  uint8_t slot_looks_ = 0, slots_ = 0;  // a slot in looks, the time in slots
  uint8_t look_ = 0;                    // of this slot; at the first one the slot before is judged
};

}  // namespace supervisor
