// The tick: from the potentiometers to the motors' duties, within what the supervisor allows. Between two ticks it
// takes orders: a host's, by the link server, and its own, such as the safe set after unrest.
#pragma once
#include <joint_guard.h>
#include <link/schema.h>
#include <stdint.h>
#include <supervisor.h>

#include "controllers.h"
#include "drive.h"
#include "lead.h"
#include "memory_check.h"
#include "parameter_sets.h"
#include "sampling.h"
#include "scaling.h"

namespace app {

class Tick {
 public:
  constexpr Tick()
      : looked_(false), checked_(false), reference_moved_(false), set_touched_(false), set_was_touched_(false) {}
  void begin();
  void run();  // when hal::tick_pending()

  // --- Between two ticks, in this order.
  // Moves the host's reference on, once in each tick and before anything else. When the motors have gone off, for
  // whatever reason, the leader arm leads again before any request is taken. False when there was nothing to do.
  bool move_reference();
  // Looks at a joint and prepares the next tick, once after each. False when that has been done.
  bool look_and_prepare();
  // Checks some of the memory that the tick works by, once after each. False when that has been done.
  bool check_memory();
  // A set is being applied, or has been since the last tick, or the motors wait for the safe set.
  bool set_changes() const { return sets_.applying() || set_touched_ || sets_.safe() == ParameterSets::Safe::applied; }
  ParameterSets::Progress apply_step();  // while sets().applying()
  // Starts the motors again, with the safe set. False while no tick has run with it.
  bool start_with_safe_set();

  // --- What a host may want.
  supervisor::Reply enable(uint16_t lease_ms);
  supervisor::Reply enable_with_host_leading(uint16_t lease_ms);
  supervisor::Reply clear_fault();
  void stop();
  void use_clutch(bool disengage);
  void reset_clutch();  // while the motors are off
  void renew(uint16_t lease_ms) { supervisor_.renew(lease_ms); }
  Lead::Verdict take_point(const wire::LeadPointRequest& point) { return lead_.take(point, sampling_); }
  void note_lost_bytes();
  ParameterSets& sets() { return sets_; }

  // --- What a host may know.
  const ParameterSets& sets() const { return sets_; }
  const supervisor::Supervisor& supervisor() const { return supervisor_; }
  const Sampling& sampling() const { return sampling_; }
  const Controllers& controllers() const { return controllers_; }
  const Lead& lead() const { return lead_; }
  wire::Clutch clutch() const { return scaling_.clutch(); }
  // What the last tick has taken for the leader's angle; with the motors off its own, without ratio and clutch.
  int16_t leader(uint8_t joint) const;
  uint32_t number() const { return number_; }
  uint16_t late_ticks() const { return late_ticks_; }  // stops at 65535
  uint16_t longest_us() const { return longest_us_; }  // tick, from the timer's start to its end

 private:
  void count(hal::TickStart start);
  void supervise(bool late);
  bool estop_pressed() const;
  bool clutch_pressed() const;
  bool follow_leader();
  // Switches the drivers as the supervisor has decided. Call it wherever the supervisor may have changed its mind.
  void follow_supervisor() {
    if (supervisor_.motors_on() != drivers_on_) switch_drivers();
  }
  void switch_drivers();
  void leader_leads();
  int16_t leader_arm(uint8_t joint) const;  // what its potentiometer says, q12 rad
  bool is_led_by_leader(uint8_t joint) const;
  void control();
  template <uint8_t joint>
  void control_joint(uint16_t limit_mv);
  void set_limit();
  void note_rails();
  void look_at_probe();
  void look_at_joint();
  void begin_safe_set();
  void prepare_next();
  void take_running_set();
  supervisor::Distances distances() const;

  Part checked_part(uint8_t number) const;
  bool check_some_bytes();
  void learn_memory();

  Sampling sampling_;
  Controllers controllers_;
  Drive drive_;
  supervisor::Supervisor supervisor_;
  supervisor::JointGuard guard_;
  supervisor::Observation seen_ = {};  // what the last tick has seen
  ParameterSets sets_;
  Lead lead_;
  Scaling scaling_;
  MemoryCheck memory_;

  uint32_t number_ = 0;
  uint16_t late_ticks_ = 0, longest_us_ = 0;
  uint8_t until_control_ = 0;  // ticks
  uint8_t short_stop_ = 0;     // ticks that are left of one
  bool drivers_on_ = false;
  bool looked_ : 1, checked_ : 1, reference_moved_ : 1;  // since the last tick
  // By a step of applying it since the last tick, or since the one before. Such a step may delay a tick so far that the
  // next one is late as well; neither is counted.
  bool set_touched_ : 1, set_was_touched_ : 1;
};

}  // namespace app
