// What a joint's motor may get until the next look at the joint: all, a gentle push, or what holds it against gravity.
// After a short hold, as an abrupt move may bring one, all comes back at once. After a long one, or many in a row, it
// comes back step by step from a gentle push on: at once it would throw the arm after a hand that lets go, and beat
// against a hand that gives way like a spring: pushed back by a motor that has all, held back, pressed away, and again.
// A motor that drives its joint at more than 1 rad/s meanwhile gets less. All comes back quickly while the controller
// asks for less than half of it, and while it brakes: a joint on its way to its reference, or a pitch joint that goes
// away from it and may be falling. Below a gentle push, a joint that moves while its reading lies would not be found.
#pragma once
#include <signal_chain/cosine.h>
#include <stdint.h>

#include "supervisor.h"

namespace supervisor {

// The pitch of the two joints that carry something, and the voltages that hold them where their links are level.
struct Gravity {
  int16_t pitch_1, pitch_2;                  // q12 rad, of joint 2 from link 1
  int8_t link_1, link_2, link_2_at_joint_2;  // 0.1 V; the first two at joint 1
};

class JointGuard {
 public:
  // One look at a joint, between ticks, by the supervisor's rules. The guard fills in seen.gravity_mv.
  void look(Supervisor& supervisor, uint8_t joint, JointSeen seen, const MotionLimits& limits, const Gravity& gravity) {
    seen.gravity_mv = static_cast<int16_t>(gravity_mv(joint, gravity) + supervisor.load_mv(joint));
    supervisor.look_at_joint(joint, seen, limits);
    const Hold hold = supervisor.hold(joint);
    uint16_t& most = most_mv_[joint];
    uint8_t& held = held_[joint];
    if (hold == Hold::unknown) held = 0;
    if (hold > Hold::free) {
      most = held_mv(hold, seen, limits);
      held = held > UINT8_MAX - held_longer ? UINT8_MAX : static_cast<uint8_t>(held + held_longer);
      return;
    }
    if (held >= held_long && most < all_mv) return come_back(supervisor, joint, seen, limits, gravity);
    most = UINT16_MAX;
    if (held > 0) --held;
  }
  uint16_t most_mv(uint8_t joint) const { return most_mv_[joint]; }

 private:
  // What a joint gave way to may have been a hand: a gentle push carries what is known of gravity alone.
  void come_back(const Supervisor& supervisor, uint8_t joint, JointSeen seen, const MotionLimits& limits,
                 const Gravity& gravity) {
    uint16_t& most = most_mv_[joint];
    seen.gravity_mv = gravity_mv(joint, gravity);
    const uint16_t least = held_mv(Hold::gentle, seen, limits);
    const bool up = seen.volts_mv > 0, spare = size_of(seen.volts_mv) < most / 2;
    const bool braked = supervisor.goes(joint, !up) && (may_fall(joint) || supervisor.goes(joint, seen.error > 0));
    if (spare || braked) most = static_cast<uint16_t>(most + quickly_mv);
    else if (!supervisor.goes_fast(joint, up)) most = static_cast<uint16_t>(most + comes_back_mv);
    else if (most > quickly_mv) most = static_cast<uint16_t>(most - quickly_mv);
    if (most < least) most = least;
  }
  static bool may_fall(uint8_t joint) { return joint == 1 || joint == 2; }
  static int16_t gravity_mv(uint8_t joint, const Gravity& gravity);
  static uint16_t held_mv(Hold hold, const JointSeen& seen, const MotionLimits& limits);

  static constexpr uint16_t all_mv = 32767;      // more than any supply
  static constexpr uint16_t comes_back_mv = 32;  // a look, 8 V/s
  static constexpr uint16_t quickly_mv = 512;    // 128 V/s
  // A look that holds a joint counts four of those that do not; 0.1 s without a look in between is long.
  static constexpr uint8_t held_longer = 4, held_long = 100;

  uint16_t most_mv_[joint_count] = {};
  uint8_t held_[joint_count] = {};  // of late, in looks that do not hold
};

// The pitch joints carry what the cosine of the pitch says.
inline int16_t JointGuard::gravity_mv(uint8_t joint, const Gravity& gravity) {
  if (!may_fall(joint)) return 0;
  const auto pitch = static_cast<int16_t>(gravity.pitch_1 + gravity.pitch_2);
  auto volts =
      static_cast<int16_t>(signal_chain::cosine(pitch) * (joint == 1 ? gravity.link_2 : gravity.link_2_at_joint_2));
  if (joint == 1) volts = static_cast<int16_t>(volts + signal_chain::cosine(gravity.pitch_1) * gravity.link_1);
  return static_cast<int16_t>(volts - (volts >> 2) + (volts >> 5));  // from 1/1280 V
}

// A joint that does not move is pushed with half as much again as starts it. One that is held back gets what holds it
// against gravity, less half of what friction holds, and nothing with gravity.
inline uint16_t JointGuard::held_mv(Hold hold, const JointSeen& seen, const MotionLimits& limits) {
  const uint8_t breakaway = limits.travel.breakaway;
  int32_t mv = seen.error < 0 ? -seen.gravity_mv : seen.gravity_mv;
  if (hold == Hold::back) mv -= breakaway * 50;
  else mv += static_cast<uint16_t>((breakaway != 0 ? breakaway : limits.stall) * 150u);
  return mv <= 0 ? uint16_t{0} : static_cast<uint16_t>(mv);
}

}  // namespace supervisor
