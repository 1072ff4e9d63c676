// See watcher.h.
#include "watcher.h"

#include <signal_chain/pot.h>

#include <algorithm>
#include <cstdlib>

#include "must.h"
#include "sets.h"

namespace attack {
namespace {

constexpr std::uint8_t short_stop_ticks = 64;

bool on(wire::State state) { return state == wire::State::soft_start || state == wire::State::following; }

template <class Message>
bool holds(const std::vector<Frame>& frames, Message& out) {
  return std::any_of(frames.begin(), frames.end(), [&](const Frame& frame) { return frame.read(out); });
}

params::Table defaults() {
  params::Table table;
  params::load_defaults(table);
  return table;
}

params::Table safe_form(params::Table table) {
  for (std::uint8_t i = 0; i < hal::joint_count; ++i) params::make_safe(table, i);
  return table;
}

}  // namespace

// --- boots

void Watcher::before_cut() {
  if (!save_asked_) return;
  const wire::SaveState state = machine_.status().save_state;
  must(state == wire::SaveState::saving || state == wire::SaveState::saved, "a save goes on or has ended well");
  if (state == wire::SaveState::saved) stored_.clear();
  else may_have_lost_ = true;
  stored_.push_back(saving_);
}

void Watcher::after_boot(bool damaged) {
  if (stored_.empty()) stored_ = {defaults()};
  running_ = machine_.running();
  must(params::first_invalid(running_) == params::none, "only a valid set runs after a boot");
  const bool known = std::any_of(stored_.begin(), stored_.end(), [&](const auto& one) { return same(one, running_); });
  must(known || damaged, "after a boot the saved set runs");
  may_have_lost_ = may_have_lost_ || damaged;
  must(!board.drivers, "the motors are off after a boot");
  law_.take(running_);
  staged_ = running_;
  stored_ = {running_};
  pressed_ = save_asked_ = applying_ = leading_ = safe_begun_ = safe_used_ = just_granted_ = reference_known_ = false;
  short_stop_ = 0;
  ticks_at_rail_ = {};
}

// --- ticks

bool Watcher::at_rail(std::uint8_t pot) const {
  const int rail = running_.rail_counts, count = board.counts[pot];
  return rail != 0 && (count <= std::max(rail, 3) || count >= 1023 - std::max(rail, 3));
}

bool Watcher::estop_pressed() const {
  return running_.estop_input != 0 && board.estop_low == (running_.estop_input == 1);
}

void Watcher::note_rails() {
  if (!board.samples_ready) return;
  for (std::uint8_t pot = 0; pot < hal::pot_count; ++pot) {
    std::uint8_t& run = ticks_at_rail_[pot];
    run = !at_rail(pot) ? std::uint8_t{0} : static_cast<std::uint8_t>(std::min(run + 1, 3));
    must(run < 3 || !board.drivers, "the motors are off in the third tick in a row with a potentiometer at a rail");
  }
}

void Watcher::tick() {
  const bool were_on = board.drivers, late = board.late || !board.samples_ready;
  machine_.tick();
  must(were_on || !board.drivers, "no tick starts the motors");
  must(!late || !board.drivers, "the motors are off after a late tick");
  pressed_ = estop_pressed();
  must(!pressed_ || !board.drivers, "the motors are off while the emergency stop is pressed");
  note_rails();
  just_granted_ = false;
  for (const int duty : board.duty) {
    must(std::abs(duty) <= hal::fake::full_duty, "no duty is above the full one");
    must(board.drivers || duty == 0, "no duty without drivers");
  }
  if (!board.drivers) {
    if (were_on) went_off(false);
    if (short_stop_ != 0) --short_stop_;
    return;
  }
  law_.tick();
  if (lease_ != 0) must(--lease_ != 0, "the motors are off when the lease has run out");
}

// --- the work between ticks

bool Watcher::service() {
  const Piece piece = machine_.service();
  must(board.tx_misuse == 0, "nothing is sent without room");
  must(board.eeprom_misuse == 0, "a busy EEPROM is left alone");
  if (piece.heard) hear(piece);
  follow_drivers(piece);
  for (const Frame& frame : piece.sent) read(frame);
  return piece.more;
}

void Watcher::hear(const Piece& piece) {
  const Frame& request = piece.frame;
  must(!applying_, "no request is taken while a set is being applied");
  wire::StopRequest stop;
  if (request.read(stop)) must(!board.drivers, "a stop turns the motors off");
  hear_set(request);
  hear_motors(request, piece);
  wire::ParamApplyRequest apply;
  wire::Nack nack;
  if (request.read(apply) && !holds(piece.sent, nack)) {
    must(!board.drivers, "a set is applied with the motors off only");
    applying_ = true;
    apply_crc_ = apply.crc;
  }
}

void Watcher::hear_set(const Frame& request) {
  wire::ParamSetRequest one;
  wire::ParamDefaultsRequest all;
  wire::ParamSaveRequest save;
  if (request.read(one)) params::set(staged_, one.index, one.value);
  if (request.read(all)) staged_ = defaults();
  if (request.read(save)) hear_save();
}

// A set is applied only when no save goes on. So if another set runs now, the save before has ended.
void Watcher::hear_save() {
  if (save_asked_ && !same(saving_, running_)) stored_ = {saving_};
  saving_ = running_;
  save_asked_ = true;
}

void Watcher::hear_motors(const Frame& request, const Piece& piece) {
  wire::EnableRequest enable;
  wire::LeadRequest lead;
  wire::RenewRequest renew;
  wire::EnableReply enabled;
  wire::LeadReply led;
  wire::RenewReply renewed;
  if (request.read(enable) && holds(piece.sent, enabled)) {
    must(board.drivers && !leading_, "enable was granted, and the leader arm leads");
    lease_ = enable.lease_ms;
    just_granted_ = !piece.drivers_were_on;
  }
  if (request.read(lead) && holds(piece.sent, led)) {
    must(board.drivers && lead.lease_ms != 0, "lead was granted, with a lease");
    must(leading_ || !piece.drivers_were_on, "the host takes the lead with the motors off only");
    lease_ = lead.lease_ms;
    leading_ = true;
  }
  if (request.read(renew) && holds(piece.sent, renewed) && board.drivers) {
    must(!leading_ || renew.lease_ms != 0, "a host that leads has a lease");
    lease_ = renew.lease_ms;
  }
}

void Watcher::follow_drivers(const Piece& piece) {
  if (board.drivers && !piece.drivers_were_on) went_on(piece);
  if (!board.drivers && piece.drivers_were_on) {
    wire::StopRequest stop;
    went_off(piece.heard && piece.frame.read(stop));
  }
}

void Watcher::went_on(const Piece& piece) {
  wire::EnableReply enabled;
  wire::LeadReply led;
  const bool asked = piece.heard && (holds(piece.sent, enabled) || holds(piece.sent, led));
  must(asked || safe_begun_, "only a request starts the motors, or the board itself after unrest");
  must(!pressed_, "nothing starts while the emergency stop is pressed");
  safe_begun_ = false;
  reference_known_ = false;
  law_.start(short_stop_ != 0);
}

// After unrest the board goes on by itself with the safe set, when it may.
void Watcher::went_off(bool by_host) {
  const bool host_led = leading_;
  leading_ = just_granted_ = reference_known_ = false;
  short_stop_ = by_host ? short_stop_ticks : std::uint8_t{0};
  const wire::StatusReply status = machine_.status();
  judge_memory(status);
  if (by_host || host_led || safe_used_ || !restarts_by_itself(status)) return;
  safe_begun_ = safe_used_ = true;
  running_ = staged_ = safe_form(running_);
  law_.take(running_);
}

bool Watcher::restarts_by_itself(const wire::StatusReply& status) const {
  return running_.unrest_action == 1 && status.stop_reason == wire::StopReason::fault &&
         status.fault == wire::Fault::unrest && status.save_state != wire::SaveState::saving;
}

// --- what the board says

void Watcher::read(const Frame& sent) {
  wire::ParamApplyReply reply;
  wire::Nack nack;
  wire::Sample sample;
  wire::LeadReply led;
  wire::LeadPointReply point;
  if (sent.read(reply)) applied(reply.param_crc);
  if (sent.read(nack) && nack.request == wire::ParamApplyRequest::type) applying_ = false;
  if (sent.read(sample)) read_sample(sample);
  if (sent.read(led)) next_point_ = led.next;
  if (sent.read(point)) next_point_ = point.next;
}

void Watcher::applied(std::uint16_t crc) {
  must(applying_ && crc == apply_crc_, "a set is applied when that was asked for, with the CRC that was given");
  must(params::crc(staged_) == crc, "the staged set is the one that was sent, value by value");
  must(params::first_invalid(staged_) == params::none, "a set that contradicts itself is refused");
  must(!board.drivers, "a set is applied with the motors off only");
  applying_ = safe_begun_ = safe_used_ = false;
  running_ = staged_;
  law_.take(running_);
  ticks_at_rail_ = {};
  must(same(machine_.running(), running_), "the set that runs is the one that was applied");
}

void Watcher::read_sample(const wire::Sample& sample) {
  must(on(sample.state) == board.drivers, "the state tells whether the motors are on");
  if (!board.drivers) {
    for (const std::int16_t volts : sample.voltage) must(volts == 0, "no voltage with the motors off");
    return;
  }
  law_.judge(sample, leading_);
  if (leading_) judge_reference(sample);
  if (!just_granted_) return;
  for (std::uint8_t i = 0; i < hal::joint_count; ++i) {
    const params::JointParameters& own = running_.joint[i];
    const int leader = signal_chain::clamp(sample.leader[i], own.limit_min, own.limit_max);
    must(std::abs(leader - sample.follower[i]) <= running_.enable_limit, "a follower that is too far does not start");
  }
}

// A point is at most 127 steps of 4 away and takes 16 ticks: 32 in a tick, and one for rounding. An error that is as
// large as it can be told hides the reference.
void Watcher::judge_reference(const wire::Sample& sample) {
  constexpr int largest_step = 33, hidden = 32767;
  const bool follows = reference_known_ && sample.tick == reference_tick_ + 1;
  reference_known_ = true;
  reference_tick_ = sample.tick;
  for (std::uint8_t i = 0; i < hal::joint_count; ++i) {
    const int now = sample.leader[i];
    if (std::abs(now - sample.follower[i]) >= hidden) reference_known_ = false;
  }
  for (std::uint8_t i = 0; i < hal::joint_count && reference_known_; ++i) {
    const params::JointParameters& own = running_.joint[i];
    const int now = sample.leader[i];
    must(now >= own.limit_min - 1 && now <= own.limit_max + 1, "the host leads within the limits only");
    must(!follows || std::abs(now - reference_[i]) <= largest_step, "the host's reference does not jump");
    reference_[i] = sample.leader[i];
  }
}

void Watcher::judge_memory(const wire::StatusReply& status) const {
  must(may_have_lost_ || status.fault != wire::Fault::params, "no set is called lost that is not");
  must(status.fault != wire::Fault::memory, "memory that nobody has changed is found as it was");
}

void Watcher::at_end() {
  judge_memory(machine_.status());
  if (!applying_) must(same(machine_.running(), running_), "the set that runs is the one that was applied last");
}

}  // namespace attack
