// See supervisor.h.
#include "supervisor.h"

namespace supervisor {
namespace {

struct BadPot {
  Fault fault;  // none: all are good
  uint8_t pot;
};

// The first at the lower rail, or else at the upper.
__attribute__((noinline)) BadPot find_bad_pot(uint8_t low, uint8_t high) {
  const Fault fault = low ? Fault::pot_low : Fault::pot_high;
  uint8_t mask = low ? low : high;
  if (!mask) return {Fault::none, nowhere};
  uint8_t pot = 0;
  for (; !(mask & 1); ++pot) mask = static_cast<uint8_t>(mask >> 1);
  return {fault, pot};
}

}  // namespace

void Supervisor::begin(bool after_watchdog, bool params_ok) {
  boot_left_ = boot_ticks;
  stop_reason_ = StopReason::reset;
  fault_where_ = nowhere;
  params_ok_ = params_ok;
  boot_fault_ = after_watchdog ? Fault::watchdog : params_ok ? Fault::none : Fault::params;
}

void Supervisor::set_limits(const Limits& limits) {
  limits_ = limits;
  if (limits.tracking_limit == 0) limits_.tracking_limit = UINT16_MAX;
}

void Supervisor::tick(const Observation& seen) {
  if (state_ == State::boot) {
    if (--boot_left_ == 0) {
      state_ = State::disabled;
      if (boot_fault_ != Fault::none) {
        state_ = State::fault;
        fault_ = boot_fault_;
      }
    }
    return;
  }
  if (seen.estop) raise_always(Fault::estop);
  if (motors_on()) watch(seen);
  if (state_ == State::soft_start && soft_start_.ended()) state_ = State::following;
}

// A stop that is pressed counts with the motors off as well: somebody wants nothing to start. So does damaged memory. A
// fault that stands already stays to be seen, but not one after which the board would start the motors again by itself.
__attribute__((noinline)) void Supervisor::raise_always(Fault fault) {
  if (motors_on()) return raise(fault, nowhere);
  if (state_ == State::fault && fault_ != Fault::unrest) return;
  state_ = State::fault;
  fault_ = fault;
  fault_where_ = nowhere;
}

void Supervisor::lose_params() {
  params_ok_ = false;
  if (state_ == State::boot) boot_fault_ = Fault::memory;
  else raise_always(Fault::memory);
}

// Faults come before the lease, the gravest first: only one is reported.
void Supervisor::watch(const Observation& seen) {
  if (seen.late) return raise(Fault::late_tick, nowhere);
  if (lease_ && --lease_ == 0) switch_off(State::disabled, StopReason::lease);
}

void Supervisor::params_mended() {
  params_ok_ = true;
  if (state_ == State::disabled) forget_fault();
}

void Supervisor::forget_fault() {
  fault_ = Fault::none;
  fault_where_ = nowhere;
}

bool Supervisor::restart(const Observation& seen, const Distances& distances) {
  if (fault_ != Fault::unrest || state_ != State::fault) return false;
  state_ = State::disabled;
  if (enable(lease_, seen, distances).refusal == NackCode::none) return true;
  state_ = State::fault;
  return false;
}

void Supervisor::bytes_lost(uint16_t tick) {
  if (motors_on() && overruns_.lost(tick)) raise(Fault::flood, nowhere);
}

void Supervisor::note_rails(uint8_t low, uint8_t high) {
  rails_.fill(low, high);
  if (!motors_on()) return;
  const BadPot bad = find_bad_pot(rails_.bad_low(), rails_.bad_high());
  if (bad.fault != Fault::none) raise(bad.fault, bad.pot);
}

void Supervisor::look_at_joint(uint8_t joint, const JointSeen& seen, const MotionLimits& limits) {
  rails_.leak(joint);
  if (state_ == State::soft_start && !soft_start_.ended()) soft_start_.advance();
  if (motors_on()) watch_joint(joint, seen, limits);
}

void Supervisor::look_at_leader(uint16_t number, int16_t reading, bool leads, uint8_t speed_limit) {
  if (!jumps_.look(number, reading, speed_limit) || !leads || !motors_on()) return;
  raise(Fault::leader_jump, static_cast<uint8_t>(number % joint_count));
}

void Supervisor::watch_joint(uint8_t joint, const JointSeen& seen, const MotionLimits& limits) {
  const auto reference = static_cast<int16_t>(seen.follower + seen.error);
  const MotionFault fault = motion_.look(joint, seen, limits);
  if (fault == MotionFault::stalled) return raise(Fault::stalled, joint);
  // A joint whose swings grow comes to be too fast, or goes far against its voltage, before they have lasted.
  if (fault != MotionFault::none && unrest_.swings(joint)) return raise(Fault::unrest, joint);
  if (fault == MotionFault::speed) return raise(Fault::speed, joint);
  if (fault == MotionFault::runaway) return raise(Fault::runaway, joint);
  if (is_lost(joint, seen.error)) return raise(Fault::tracking, joint);
  if (unrest_.look(joint, reference, seen.error)) return raise(Fault::unrest, joint);
  if (motion_.hold(joint) != Hold::free) unrest_.forget(joint);
}

// A look comes every four ticks. A feeble joint on its way is not lost.
bool Supervisor::is_lost(uint8_t joint, int16_t error) {
  uint16_t& lost = lost_ms_[joint];
  const bool near = size_of(error) <= limits_.tracking_limit;
  if (near) lost = 0;
  if (near || motion_.goes(joint, error > 0)) return false;
  lost = static_cast<uint16_t>(lost + joint_count);
  return lost >= limits_.tracking_ms;
}

void Supervisor::switch_off(State next, StopReason reason) {
  state_ = next;
  stop_reason_ = reason;
  soft_start_.stop();
}

void Supervisor::raise(Fault fault, uint8_t where) {
  switch_off(State::fault, StopReason::fault);
  fault_ = fault;
  fault_where_ = where;
}

__attribute__((cold)) Reply Supervisor::enable(uint16_t lease_ms, const Observation& seen, const Distances& distances) {
  if (motors_on()) {
    lease_ = lease_ms;
    return {NackCode::none, nowhere, 0};
  }
  if (state_ == State::boot) return {NackCode::booting, nowhere, 0};
  if (state_ == State::fault) return {NackCode::in_fault, nowhere, static_cast<uint16_t>(fault_)};
  if (seen.estop) return {NackCode::estop_pressed, nowhere, 0};
  const BadPot bad = find_bad_pot(rails_.bad_low() | seen.rail_low, rails_.bad_high() | seen.rail_high);
  if (bad.fault != Fault::none) return {NackCode::pot_bad, bad.pot, static_cast<uint16_t>(bad.fault)};
  for (uint8_t i = 0; i < joint_count; ++i) {
    const uint16_t distance = distances.of[i];
    if (distance > limits_.enable_limit) return {NackCode::error_too_large, i, distance};
    lost_ms_[i] = 0;
  }
  state_ = State::soft_start;
  soft_start_.start(limits_.soft_start_ms);
  soft_start_.advance();
  overruns_.forget();
  unrest_.forget();
  motion_.forget();
  jumps_.forget();
  lease_ = lease_ms;
  return {NackCode::none, nowhere, 0};
}

void Supervisor::stop() {
  if (motors_on()) switch_off(State::disabled, StopReason::host);
}

void Supervisor::renew(uint16_t lease_ms) {
  if (motors_on()) lease_ = lease_ms;
}

__attribute__((cold)) Reply Supervisor::clear_fault(const Observation& seen, const Distances& distances) {
  if (state_ == State::boot) return {NackCode::booting, nowhere, 0};
  if (state_ != State::fault) return {NackCode::none, nowhere, 0};
  if (seen.estop) return {NackCode::estop_pressed, nowhere, 0};
  const BadPot bad = find_bad_pot(rails_.bad_low(), rails_.bad_high());
  if (bad.fault != Fault::none) return {NackCode::pot_bad, bad.pot, static_cast<uint16_t>(bad.fault)};
  if (!params_ok_) return {NackCode::set_lost, nowhere, 0};
  if (fault_ == Fault::late_tick && seen.late) return {NackCode::in_fault, nowhere, static_cast<uint16_t>(fault_)};
  if (fault_ == Fault::tracking) {
    const uint16_t distance = distances.of[fault_where_];
    if (distance > limits_.tracking_limit) return {NackCode::error_too_large, fault_where_, distance};
  }
  state_ = State::disabled;
  forget_fault();
  return {NackCode::none, nowhere, 0};
}

}  // namespace supervisor
