// The tick: samples, supervisor, controllers, duties. The other half of App is in requests.cpp.
#include "app.h"

#include <hal.h>

namespace app {
namespace {

uint16_t add_saturated(uint16_t count, uint8_t more) {
  return count > UINT16_MAX - more ? uint16_t{UINT16_MAX} : static_cast<uint16_t>(count + more);
}

constexpr uint8_t watched_parts = hal::joint_count + 4;

}  // namespace

void App::begin() {
  const bool same_set = sets_.begin(controllers_);
  take_running_set();
  supervisor_.begin(hal::reset_cause() == hal::ResetCause::watchdog, same_set);
  hal::begin();
  hal::watchdog_start();
}

// Hands the running set to those who keep parts of it in a form of their own. The controllers have taken theirs joint
// by joint.
void App::take_running_set() {
  const params::Table& table = sets_.running();
  sampling_.configure(table);
  drive_.configure(table);
  supervisor_.set_limits({table.enable_limit, table.tracking_limit, table.tracking_ms, table.soft_start_ms});
  supervisor_.set_unrest_limits({table.unrest_amplitude, table.unrest_rate, table.unrest_time});
  learn_memory();
}

// What a set has become, part by part.
Part App::watched(uint8_t part) const {
  if (part < hal::joint_count) return controllers_.coefficients(part);
  if (part == hal::joint_count) return {reinterpret_cast<const uint8_t*>(&sets_.running()), sizeof(params::Table)};
  if (part == hal::joint_count + 1) return drive_.settings();
  if (part == hal::joint_count + 2) return sampling_.rails();
  return {reinterpret_cast<const uint8_t*>(&supervisor_.running_limits()), sizeof(supervisor::Limits)};
}

// Some bytes; false at the end of a round.
__attribute__((noinline)) bool App::look_on() {
  memory_.add(watched(memory_.part()));
  return memory_.part() < watched_parts;
}

void App::learn_memory() {
  memory_.restart();
  while (look_on()) {
  }
  memory_.learn();
}

// Some bytes after each tick, but not while a set is being applied.
__attribute__((noinline)) void App::watch_memory() {
  if (sets_.applying()) return memory_.restart();
  const uint8_t joint = static_cast<uint8_t>(tick_) % hal::joint_count;
  if (!sampling_.configure(sets_.running(), joint, lead_.on()) && (look_on() || memory_.ends_well())) return;
  supervisor_.lose_params();
  follow_supervisor();
}

void App::tick() {
  const hal::TickStart start = hal::tick_begin();
  count_ticks(start);
  if (const uint16_t* sums = hal::pot_sums()) {
    sampling_.tick(sums, seen_);
    hal::release_pots();
  }
  supervise(start.late);
  follow_supervisor();
  if (drivers_on_) control();
  const uint16_t age_us = hal::tick_age_us();
  if (age_us > tick_us_max_ && !excused_) tick_us_max_ = age_us;
  excused_ = looked_ = false;
  hal::watchdog_kick();
  hal::tick_end();
}

void App::count_ticks(hal::TickStart start) {
  tick_ += start.elapsed;
  if (!start.late || excused_) return;
  late_ticks_ = add_saturated(late_ticks_, start.elapsed > 1 ? static_cast<uint8_t>(start.elapsed - 1) : uint8_t{1});
}

// A closing button pulls its input low. An opening one holds it low until it is pressed, or until a wire breaks.
inline bool App::estop_pressed() const {
  const uint8_t button = sets_.running().estop_input;
  return button != 0 && hal::estop_low() == (button == 1);
}

void App::supervise(bool late) {
  seen_.late = late;
  seen_.estop = estop_pressed();
  const bool booting = supervisor_.state() == supervisor::State::boot;
  supervisor_.tick(seen_);
  if ((seen_.rail_low | seen_.rail_high) != 0) look_at_rails();
  if (booting && supervisor_.state() != supervisor::State::boot) hello_due_ = true;
}

__attribute__((noinline)) void App::switch_drivers() {
  drivers_on_ = !drivers_on_;
  if (!drivers_on_) hal::set_drivers(false);
  controllers_.reset();
  drive_.release();
  sampling_.hold(drivers_on_);
  until_control_ = 1;
  set_limit();
  if (drivers_on_) hal::set_drivers(true);
}

// Each joint is written out: its number, known at compile time, makes its registers constants.
void App::control() {
  if (--until_control_) return;
  until_control_ = sets_.running().period_ms;
  const uint16_t limit_mv = controllers_.limit_mv();
  control_joint<0>(limit_mv);
  control_joint<1>(limit_mv);
  control_joint<2>(limit_mv);
  control_joint<3>(limit_mv);
}

template <uint8_t joint>
inline __attribute__((always_inline)) void App::control_joint(uint16_t limit_mv) {
  const Outcome out = controllers_.step(joint, sampling_.error(joint), limit_mv);
  drive_.set<joint>(out.size_mv, out.sign, sets_.running());
}

// What each tick leaves for the time before the next one: nothing here matters to its own duties.
__attribute__((noinline)) void App::after_tick() {
  sampling_.prepare();
  set_limit();
  schedule_sample();
  show_state();
}

void App::set_limit() { controllers_.set_limit(sets_.running().supply_mv, supervisor_.share_q15()); }

// A sample is dropped when it could not be sent before the next one is due. Its sequence number is then never sent.
void App::schedule_sample() {
  if (every_ == 0 || --until_sample_) return;
  until_sample_ = every_;
  ++sample_seq_;
  if (sample_due_) telemetry_dropped_ = add_saturated(telemetry_dropped_, 1);
  sample_due_ = true;
}

// Sets the LED every 32 ms: on while following, quick while starting, a short flash each second while disabled, 4 Hz in
// fault.
void App::show_state() {
  if (static_cast<uint8_t>(tick_) & 31) return;
  const auto ms = static_cast<uint16_t>(tick_);
  switch (supervisor_.state()) {
    case supervisor::State::boot:
    case supervisor::State::following: hal::set_led(true); break;
    case supervisor::State::disabled: hal::set_led((ms & 1023) < 64); break;
    case supervisor::State::soft_start: hal::set_led(ms & 32); break;
    case supervisor::State::fault: hal::set_led(ms & 128); break;
  }
}

}  // namespace app
