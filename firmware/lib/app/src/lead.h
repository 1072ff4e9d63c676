// The reference when the host leads in place of the leader arm: a uniform quadratic B-spline whose control points wait
// in a short queue. It is computed between ticks; a tick sees leader angles only, as it always does.
#pragma once
#include <hal.h>
#include <link/schema.h>
#include <stdint.h>

#include "sampling.h"

namespace app {

class Lead {
 public:
  static constexpr uint8_t room = 12;             // points that can wait
  static constexpr uint8_t ticks_per_point = 16;  // the arithmetic of advance() depends on it

  bool on() const { return on_; }
  // From now on the reference rests at the followers' pose, within the joints' limits.
  void begin(Sampling& sampling);
  void end() { on_ = false; }

  struct Verdict {
    wire::LeadRefusal refusal;
    uint8_t joint;
  };
  // Takes a point if it is the next one and there is room. A point that is refused changes nothing.
  Verdict take(const wire::LeadPointRequest& point, const Sampling& sampling);
  uint8_t next() const { return next_; }
  uint8_t waiting() const { return waiting_; }
  int16_t last(uint8_t joint) const { return last_[joint]; }

  // Moves the reference on by a tick.
  void advance(Sampling& sampling);

 private:
  void begin_piece();

  using Step = int8_t[hal::joint_count];  // 2^-10 rad
  Step steps_[room] = {};
  Step before_ = {}, after_ = {};        // the steps to and from the point around which the curve bends
  int16_t last_[hal::joint_count] = {};  // q12 rad, the last point taken
  uint8_t first_ = 0, waiting_ = 0;      // in steps_
  uint8_t next_ = 0;
  uint8_t done_ = 0;  // ticks of this piece
  bool on_ = false;
};

}  // namespace app
