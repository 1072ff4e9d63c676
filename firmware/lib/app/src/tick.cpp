// See tick.h.
#include "tick.h"

#include <hal.h>

#include "counting.h"

namespace app {
namespace {

// A host that stops the motors for no longer, to run another set, starts them again without a bump: what the integrals
// hold the arm with goes on.
constexpr uint8_t short_stop_ticks = 64;

constexpr uint8_t checked_parts = hal::joint_count + 4;

// Sets the LED every 32 ms: on while following, quick while starting, a short flash each second while disabled, 4 Hz in
// fault.
void show(supervisor::State state, uint16_t ms) {
  if (static_cast<uint8_t>(ms) & 31) return;
  switch (state) {
    case supervisor::State::boot:
    case supervisor::State::following: hal::set_led(true); break;
    case supervisor::State::disabled: hal::set_led((ms & 1023) < 64); break;
    case supervisor::State::soft_start: hal::set_led(ms & 32); break;
    case supervisor::State::fault: hal::set_led(ms & 128); break;
  }
}

}  // namespace

void Tick::begin() {
  const bool same_set = sets_.begin(controllers_);
  looked_ = checked_ = true;
  take_running_set();
  supervisor_.begin(hal::reset_cause() == hal::ResetCause::watchdog, same_set);
  hal::begin();
  hal::watchdog_start();
}

// Hands the running set to those who keep parts of it in a form of their own. The controllers have taken theirs joint
// by joint.
void Tick::take_running_set() {
  const params::Table& table = sets_.running();
  leader_leads();
  drive_.configure(table);
  supervisor_.set_limits({table.enable_limit, table.tracking_limit, table.tracking_ms, table.soft_start_ms});
  supervisor_.set_unrest_limits({table.unrest_amplitude, table.unrest_rate, table.unrest_time});
  learn_memory();
}

void Tick::run() {
  const hal::TickStart start = hal::tick_begin();
  count(start);
  if (const uint16_t* sums = hal::pot_sums()) {
    sampling_.tick(sums, seen_);
    hal::release_pots(static_cast<uint8_t>(number_) % hal::pot_count);
  }
  supervise(start.late);
  hal::end_pull_ups();
  follow_supervisor();
  if (drivers_on_) control();
  const uint16_t age_us = hal::tick_age_us();
  if (age_us > longest_us_ && !set_touched_) longest_us_ = age_us;
  set_was_touched_ = set_touched_;
  set_touched_ = looked_ = checked_ = reference_moved_ = false;
  hal::watchdog_kick();
  hal::tick_end();
}

void Tick::count(hal::TickStart start) {
  number_ += start.elapsed;
  if (!start.late || set_touched_ || set_was_touched_) return;
  late_ticks_ = add_saturated(late_ticks_, start.elapsed > 1 ? static_cast<uint8_t>(start.elapsed - 1) : uint8_t{1});
}

// A closing button pulls its input low. An opening one holds it low until it is pressed, or until a wire breaks.
inline bool is_pressed(uint8_t button, bool low) { return button != 0 && low == (button == 1); }

inline bool Tick::estop_pressed() const { return is_pressed(sets_.running().estop_input, hal::estop_low()); }
inline bool Tick::clutch_pressed() const { return is_pressed(sets_.running().clutch_input, hal::clutch_low()); }

void Tick::supervise(bool late) {
  seen_.late = late;
  seen_.estop = estop_pressed();
  supervisor_.tick(seen_);
  if ((seen_.rail_low | seen_.rail_high) != 0) note_rails();
}

__attribute__((noinline)) void Tick::note_rails() {
  const uint8_t pots = sampling_.pots_in_use();
  seen_.rail_low &= pots;
  seen_.rail_high &= pots;
  supervisor_.note_rails(seen_.rail_low, seen_.rail_high);
}

__attribute__((noinline)) void Tick::switch_drivers() {
  drivers_on_ = !drivers_on_;
  if (!drivers_on_) {
    hal::set_drivers(false);
    short_stop_ = supervisor_.stop_reason() == supervisor::StopReason::host ? short_stop_ticks : uint8_t{0};
  }
  controllers_.reset(short_stop_ != 0);
  drive_.release();
  sampling_.hold(drivers_on_);
  until_control_ = 1;
  set_limit();
  if (drivers_on_) hal::set_drivers(true);
}

void Tick::set_limit() { controllers_.set_limit(sets_.running().supply_mv, supervisor_.share_q15()); }

// Each joint is written out: its number, known at compile time, makes its registers constants.
void Tick::control() {
  if (--until_control_) return;
  until_control_ = sets_.running().period_ms;
  const uint16_t limit_mv = controllers_.limit_mv();
  control_joint<0>(limit_mv);
  control_joint<1>(limit_mv);
  control_joint<2>(limit_mv);
  control_joint<3>(limit_mv);
}

template <uint8_t joint>
inline __attribute__((always_inline)) void Tick::control_joint(uint16_t limit_mv) {
  if (guard_.most_mv(joint) < limit_mv) limit_mv = guard_.most_mv(joint);
  const MotorVoltage out = controllers_.step(joint, sampling_.error(joint), limit_mv);
  drive_.set<joint>(out.size_mv, out.sign, sets_.running());
}

// --- Between two ticks

bool Tick::move_reference() {
  if (lead_.on() && !drivers_on_) {
    lead_.end();
    leader_leads();
  }
  if (reference_moved_) return false;
  reference_moved_ = true;
  if (!lead_.on()) return follow_leader();
  lead_.advance(sampling_);
  return true;
}

bool Tick::follow_leader() { return scaling_.advance(drivers_on_, clutch_pressed(), sets_.running(), sampling_); }

bool Tick::look_and_prepare() {
  if (looked_) return false;
  looked_ = true;
  look_at_probe();
  look_at_joint();
  prepare_next();
  return true;
}

__attribute__((noinline)) void Tick::prepare_next() {
  sampling_.prepare_low_passes();
  set_limit();
  if (short_stop_ != 0) --short_stop_;
  show(supervisor_.state(), static_cast<uint16_t>(number_));
}

// A wire that is off counts as a reading at the lower rail, one that touches another as a reading at the upper: each
// pot comes once in eight ticks, and the rails tell what is there more often than once in sixteen.
inline void Tick::look_at_probe() {
  const hal::Probe probe = hal::last_probe();
  const Sampling::Wire wire = sampling_.judge(probe);
  if (wire == Sampling::Wire::good) return;
  const uint8_t bit = hal::pot_bit(probe.pot) & sampling_.pots_in_use();
  const bool off = wire == Sampling::Wire::off;
  supervisor_.note_rails(off ? bit : uint8_t{0}, off ? uint8_t{0} : bit);
}

// The next joint after each tick.
__attribute__((noinline)) void Tick::look_at_joint() {
  const uint8_t joint = static_cast<uint8_t>(number_) % hal::joint_count;
  const params::Table& table = sets_.running();
  const params::TravelParameters& travel = table.travel[joint];
  guard_.look(supervisor_, joint, {sampling_.follower(joint), sampling_.error(joint), controllers_.volts_mv(joint), 0},
              {table.speed_limit,
               table.runaway_limit,
               table.stall_volts,
               table.stall_time,
               {travel.speed_per_volt, travel.time_constant, travel.breakaway_volts}},
              {sampling_.follower(1), sampling_.follower(2), table.gravity_1, table.gravity_12, table.gravity_2});
  if (!drivers_on_ || supervisor_.motors_on()) return;
  follow_supervisor();
  if (supervisor_.fault() == supervisor::Fault::unrest) begin_safe_set();
}

// If the host wants one, and if there is nothing in its way. There is one safe set until a host applies another.
void Tick::begin_safe_set() {
  const bool can = !lead_.on() && sets_.save_state() != wire::SaveState::saving;
  if (can && sets_.running().unrest_action == 1 && sets_.safe() == ParameterSets::Safe::no) sets_.begin_safe();
}

ParameterSets::Progress Tick::apply_step() {
  set_touched_ = true;
  const ParameterSets::Progress progress = sets_.work_on_apply(controllers_);
  if (progress != ParameterSets::Progress::applied) return progress;
  take_running_set();
  if (sets_.safe() == ParameterSets::Safe::applied) return progress;
  sampling_.forget();
  supervisor_.params_mended();
  return progress;
}

bool Tick::start_with_safe_set() {
  if (set_touched_) return false;
  sets_.safe_runs();
  supervisor_.restart(seen_, distances());
  follow_supervisor();
  return true;
}

// --- What a host wants

supervisor::Reply Tick::enable(uint16_t lease_ms) {
  const supervisor::Reply reply = supervisor_.enable(lease_ms, seen_, distances());
  follow_supervisor();
  return reply;
}

// When the supervisor refuses, the motors stay off; move_reference() then gives the lead back to the leader arm.
supervisor::Reply Tick::enable_with_host_leading(uint16_t lease_ms) {
  if (!supervisor_.motors_on()) lead_.begin(sampling_);
  return enable(lease_ms);
}

supervisor::Reply Tick::clear_fault() { return supervisor_.clear_fault(seen_, distances()); }

void Tick::stop() {
  supervisor_.stop();
  follow_supervisor();
}

int16_t Tick::leader(uint8_t joint) const {
  // What stands in the leader's place has moved on since.
  if (drivers_on_ && (lead_.on() || scaling_.on())) return sampling_.reference(joint);
  return leader_arm(joint);
}

int16_t Tick::leader_arm(uint8_t joint) const {
  if (!lead_.on() && !scaling_.on()) return sampling_.leader(joint);
  return static_cast<int16_t>((sampling_.leader_q27(joint, sets_.running()) + 0x4000) >> 15);
}

bool Tick::is_led_by_leader(uint8_t joint) const {
  const bool in_use = (sampling_.pots_in_use() & hal::pot_bit(static_cast<uint8_t>(joint + hal::joint_count))) != 0;
  return in_use && !lead_.on() && scaling_.clutch() != wire::Clutch::disengaged;
}

void Tick::use_clutch(bool disengage) {
  scaling_.ask(disengage);
  if (!lead_.on()) follow_leader();
}

void Tick::reset_clutch() {
  scaling_.reset();
  leader_leads();
}

// While the motors are off.
__attribute__((noinline)) void Tick::leader_leads() {
  sampling_.configure(sets_.running());
  scaling_.begin(sets_.running());
  reference_moved_ = false;
}

void Tick::note_lost_bytes() {
  supervisor_.bytes_lost(static_cast<uint16_t>(number_));
  follow_supervisor();
}

supervisor::Distances Tick::distances() const {
  supervisor::Distances now;
  for (uint8_t i = 0; i < hal::joint_count; ++i) now.of[i] = sampling_.distance(i);
  return now;
}

// --- The memory that the tick works by

Part Tick::checked_part(uint8_t number) const {
  if (number < hal::joint_count) return controllers_.coefficients(number);
  if (number == hal::joint_count) return {reinterpret_cast<const uint8_t*>(&sets_.running()), sizeof(params::Table)};
  if (number == hal::joint_count + 1) return drive_.settings();
  if (number == hal::joint_count + 2) return sampling_.rails();
  return {reinterpret_cast<const uint8_t*>(&supervisor_.running_limits()), sizeof(supervisor::Limits)};
}

// False at the end of a round.
__attribute__((noinline)) bool Tick::check_some_bytes() {
  memory_.add(checked_part(memory_.part()));
  return memory_.part() < checked_parts;
}

void Tick::learn_memory() {
  memory_.restart();
  while (check_some_bytes()) {
  }
  memory_.learn();
}

// Not while a set is being applied.
__attribute__((noinline)) bool Tick::check_memory() {
  if (checked_ || sets_.applying()) return false;
  checked_ = true;
  const auto number = static_cast<uint16_t>(number_);
  const auto joint = static_cast<uint8_t>(number % hal::joint_count);
  supervisor_.look_at_leader(number, leader_arm(joint), is_led_by_leader(joint), sets_.running().speed_limit);
  follow_supervisor();
  const bool pots_are_right = !sampling_.configure_joint(sets_.running(), joint, lead_.on() || scaling_.on());
  if (pots_are_right && (check_some_bytes() || memory_.ends_well())) return true;
  supervisor_.lose_params();
  follow_supervisor();
  return true;
}

}  // namespace app
