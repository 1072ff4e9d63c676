// When the motors may run: states, faults, soft start and lease. A pure state machine that is called once in each tick.
#pragma once
#include <codes/codes.h>
#include <signal_chain/soft_start.h>
#include <stdint.h>

#include "jumps.h"
#include "motion.h"
#include "overruns.h"
#include "rails.h"
#include "unrest.h"

namespace supervisor {

constexpr uint8_t joint_count = 4;
constexpr uint8_t nowhere = 255;  // fault_where when the fault has no pot or joint

using codes::Fault;
using codes::NackCode;
using codes::State;
using codes::StopReason;

struct Limits {
  uint16_t enable_limit;    // q12 rad
  uint16_t tracking_limit;  // q12 rad, 0 = no check
  uint16_t tracking_ms;
  uint16_t soft_start_ms;
};

// What a tick has seen. Bit i of a rail mask is pot i: 0..3 leader, 4..7 follower.
struct Observation {
  uint8_t rail_low;
  uint8_t rail_high;
  bool late;
  bool estop;  // the emergency stop is pressed
};

// A joint's distance is between its reference (the leader within the joint's limits) and its follower, in q12 rad.
struct Distances {
  uint16_t of[joint_count];
};

// Why a request is refused, or NackCode::none.
struct Reply {
  NackCode refusal;
  uint8_t where;    // a pot for pot_bad, a joint for error_too_large, else nowhere
  uint16_t detail;  // the Fault for pot_bad and in_fault, the distance for error_too_large
};

class Supervisor {
 public:
  constexpr Supervisor() : boot_left_(0), params_ok_(false) {}
  // A reset by the watchdog is a fault that stands from the start. So is a set that need not be the one that ran
  // before.
  void begin(bool after_watchdog, bool params_ok);
  void set_limits(const Limits& limits);  // only while the motors are off
  const Limits& running_limits() const { return limits_; }
  void set_unrest_limits(const UnrestLimits& limits) { unrest_.configure(limits); }
  // What the controllers work by has changed in memory. The fault stands until a set is applied: params_mended().
  void lose_params();
  void params_mended();

  void tick(const Observation& seen);
  // Bytes of the link were lost in this tick: a stop may have been among them.
  void bytes_lost(uint16_t tick);
  // Potentiometers at a rail, bit i is pot i: right after tick() when it has seen any, and between ticks.
  void note_rails(uint8_t low, uint8_t high);
  // Between ticks, the next joint after each. It also moves the soft start on, which a tick has no time for.
  void look_at_joint(uint8_t joint, const JointSeen& seen, const MotionLimits& limits);
  // The same for the own reading, q12 rad, of the leader whose turn is in the tick of this number; whether the
  // reference comes from there. The limit is in rad/s.
  void look_at_leader(uint16_t number, int16_t reading, bool leads, uint8_t speed_limit);
  // After unrest: starts the motors again, within the lease as it was. The fault stays to be seen. False when refused.
  bool restart(const Observation& seen, const Distances& distances);

  // enable() and clear_fault() judge by what the last tick has seen. enable() renews the lease when the motors are on.
  Reply enable(uint16_t lease_ms, const Observation& seen, const Distances& distances);
  Reply clear_fault(const Observation& seen, const Distances& distances);
  void stop();
  void renew(uint16_t lease_ms);

  State state() const { return state_; }
  StopReason stop_reason() const { return stop_reason_; }
  Fault fault() const { return fault_; }
  uint8_t fault_where() const { return fault_where_; }
  bool motors_on() const { return state_ == State::soft_start || state_ == State::following; }
  // What a joint that does not move may get, and the voltage that it carries beyond the gravity that is known.
  Hold hold(uint8_t joint) const { return motion_.hold(joint); }
  int16_t load_mv(uint8_t joint) const { return motion_.load_mv(joint); }
  bool goes(uint8_t joint, bool up) const { return motion_.goes(joint, up); }
  bool goes_fast(uint8_t joint, bool up) const { return motion_.goes(joint, up, Motion::fast); }
  // Share of the supply that the controllers may use in the next tick; 32768 is all of it.
  uint16_t share_q15() const { return soft_start_.share_q15(); }

 private:
  void switch_off(State next, StopReason reason);
  void raise(Fault fault, uint8_t where);
  void forget_fault();
  void raise_always(Fault fault);
  void watch(const Observation& seen);
  bool is_lost(uint8_t joint, int16_t error);
  void watch_joint(uint8_t joint, const JointSeen& seen, const MotionLimits& limits);

  static constexpr uint8_t boot_ticks = 20;  // meanwhile the filters settle and bad pots are found

  Limits limits_ = {0, 0, 0, 0};  // a tracking limit of UINT16_MAX: no distance is beyond it
  Rails rails_;
  uint16_t lost_ms_[joint_count] = {};  // time beyond the tracking limit without coming nearer
  signal_chain::SoftStart soft_start_;
  Overruns overruns_;
  Unrest unrest_;
  Motion motion_;
  Jumps jumps_;
  uint16_t lease_ = 0;  // ticks, 0 = until stop; it stays after a fault, for restart()
  uint8_t boot_left_ : 7;
  bool params_ok_ : 1;
  State state_ = State::boot;
  StopReason stop_reason_ = StopReason::none;
  Fault fault_ = Fault::none;
  Fault boot_fault_ = Fault::none;
  uint8_t fault_where_ = 0;
};

}  // namespace supervisor
