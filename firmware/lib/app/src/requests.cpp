// The link's half of App: requests, replies and samples, in pieces of bounded length.
#include <hal.h>

#include "app.h"
#include "version.h"

namespace app {
namespace {

// After this time of a tick no sample, hello or byte for the EEPROM is begun, so that little delays the next tick.
constexpr uint16_t latest_start_us = 800;
constexpr uint16_t latest_apply_us = 300;  // a joint's compilation takes most of a tick
constexpr uint8_t bytes_per_piece = 20;
constexpr uint8_t calm_ticks = 4;  // behind a request none begins late for so many: by then its delay should be over

// A distance in 1/32 rad, as error_too_large carries it.
uint8_t coarse(uint16_t distance_q12) {
  const uint16_t steps = static_cast<uint16_t>((distance_q12 + 64UL) >> 7);
  return steps > 255 ? uint8_t{255} : static_cast<uint8_t>(steps);
}

uint16_t pair(uint8_t high, uint16_t low) { return static_cast<uint16_t>(high << 8 | (low & 0xff)); }

}  // namespace

bool App::service() {
  if (lead_.on() && work_on_lead()) return true;
  if (!looked_) {
    looked_ = true;
    if (heard_this_tick_) ticks_unheard_ = 0;
    else if (ticks_unheard_ < calm_ticks) ++ticks_unheard_;
    heard_this_tick_ = false;
    look_at_joint();
    watch_memory();
    after_tick();
  }
  const uint16_t age_us = hal::tick_age_us();
  const bool late_in_tick = age_us > latest_start_us;
  if (late_in_tick && (heard_this_tick_ || ticks_unheard_ < calm_ticks)) return false;
  if (const uint8_t lost = hal::rx_lost()) note_lost_bytes(lost);
  if (hal::tx_free() < wire::max_wire) return false;  // requests wait until there is room for the answer
  if (sets_.applying()) {
    if (age_us > latest_apply_us) return false;
    work_on_apply();
    return true;
  }
  if (excused_) return false;  // a set was applied: the next request must be judged by what a tick has seen with it
  if (sets_.safe() == ParameterSets::Safe::applied) {
    restart_safe();
    return true;
  }
  if (!heard_this_tick_ && hal::rx_available()) {
    receive();  // once in a few ticks, whatever else there is to do: a stop must get through
    return true;
  }
  if (late_in_tick) return false;
  if (sample_due_) {
    send_sample();
  } else if (hello_due_) {
    hello_due_ = false;
    send_hello(0);  // after boot, without a request: the host waits for the bootloader to end
  } else if (hal::rx_available()) {
    receive();
  } else {
    return sets_.work_on_save();
  }
  return true;
}

void App::note_lost_bytes(uint8_t lost) {
  rx_overruns_ = rx_overruns_ > UINT16_MAX - lost ? UINT16_MAX : static_cast<uint16_t>(rx_overruns_ + lost);
  supervisor_.bytes_lost(static_cast<uint16_t>(tick_));
  follow_supervisor();
}

// Moves the host's reference on, once in each tick and before anything else. When the motors have gone off, for
// whatever reason, the leader arm leads again before any request is taken.
bool App::work_on_lead() {
  const auto tick = static_cast<uint8_t>(tick_);
  if (drivers_on_) {
    if (!lead_.due(tick)) return false;
    lead_.advance(tick, sampling_);
    return true;
  }
  lead_.end();
  sampling_.configure(sets_.running());
  return true;
}

__attribute__((noinline)) void App::look_at_rails() {
  const uint8_t pots = sampling_.pots_in_use();
  seen_.rail_low &= pots;
  seen_.rail_high &= pots;
  supervisor_.look_at_rails(seen_);
}

// At one joint after each tick.
__attribute__((noinline)) void App::look_at_joint() {
  const uint8_t joint = static_cast<uint8_t>(tick_) % hal::joint_count;
  const params::Table& table = sets_.running();
  supervisor_.look(joint,
                   {sampling_.follower(joint), sampling_.error(joint), sampling_.distance(joint),
                    controllers_.volts_mv(joint), table.supply_mv},
                   {table.speed_limit, table.runaway_limit, table.stall_volts, table.stall_ms});
  if (!drivers_on_ || supervisor_.motors_on()) return;
  follow_supervisor();
  if (supervisor_.fault() != supervisor::Fault::unrest) return;
  const bool can = !lead_.on() && sets_.save_state() != wire::SaveState::saving;
  if (can && sets_.running().unrest_action == 1 && sets_.safe() == ParameterSets::Safe::no) sets_.begin_safe();
}

void App::restart_safe() {
  sets_.safe_runs();
  supervisor_.restart(seen_, distances());
  follow_supervisor();
}

supervisor::Distances App::distances() const {
  supervisor::Distances now;
  for (uint8_t i = 0; i < hal::joint_count; ++i) now.of[i] = sampling_.distance(i);
  return now;
}

void App::receive() {
  heard_this_tick_ = true;
  for (uint8_t left = bytes_per_piece; left && hal::rx_available(); --left) {
    if (decoder_.push(hal::rx_read())) return handle_frame();
  }
}

// One case for each declared request and no default, so that the compiler names a request without a case (-Wswitch).
void App::handle_frame() {
  request_ = decoder_.type();
  seq_ = decoder_.seq();
  switch (static_cast<wire::RequestType>(request_)) {
    case wire::RequestType::hello: return handle<wire::HelloRequest>();
    case wire::RequestType::status: return handle<wire::StatusRequest>();
    case wire::RequestType::param_get: return handle<wire::ParamGetRequest>();
    case wire::RequestType::param_set: return handle<wire::ParamSetRequest>();
    case wire::RequestType::param_apply: return handle<wire::ParamApplyRequest>();
    case wire::RequestType::param_save: return handle<wire::ParamSaveRequest>();
    case wire::RequestType::param_defaults: return handle<wire::ParamDefaultsRequest>();
    case wire::RequestType::enable: return handle<wire::EnableRequest>();
    case wire::RequestType::stop: return handle<wire::StopRequest>();
    case wire::RequestType::renew: return handle<wire::RenewRequest>();
    case wire::RequestType::clear_fault: return handle<wire::ClearFaultRequest>();
    case wire::RequestType::telemetry: return handle<wire::TelemetryRequest>();
    case wire::RequestType::lead: return handle<wire::LeadRequest>();
    case wire::RequestType::lead_point: return handle<wire::LeadPointRequest>();
  }
  refuse(wire::NackCode::unknown_type, request_);
}

template <class Request>
void App::handle() {
  Request request;
  if (Request::decode(decoder_.payload(), decoder_.payload_size(), request)) return serve(request);
  refuse(wire::NackCode::bad_length, decoder_.payload_size());
}

void App::serve(const wire::HelloRequest&) { send_hello(seq_); }

void App::serve(const wire::StatusRequest&) { send_status(); }

void App::serve(const wire::TelemetryRequest& request) {
  every_ = until_sample_ = request.every;
  sample_due_ = false;
  reply(wire::TelemetryReply{request.every});
}

void App::serve(const wire::EnableRequest& request) {
  // While the host leads, the leader arm cannot take over: it may be anywhere.
  if (lead_.on()) return refuse_not_disabled();
  if (granted(supervisor_.enable(request.lease_ms, seen_, distances()))) reply(wire::EnableReply{supervisor_.state()});
}

void App::serve(const wire::StopRequest&) {
  supervisor_.stop();
  follow_supervisor();
  reply(wire::StopReply{supervisor_.state()});
}

void App::serve(const wire::RenewRequest& request) {
  // Without a lease the motors would hold the arm for ever after the host has gone.
  if (lead_.on() && request.lease_ms == 0) return refuse_lead(wire::LeadRefusal::no_lease, 0);
  supervisor_.renew(request.lease_ms);
  reply(wire::RenewReply{supervisor_.state()});
}

void App::serve(const wire::ClearFaultRequest&) {
  if (granted(supervisor_.clear_fault(seen_, distances()))) reply(wire::ClearFaultReply{supervisor_.state()});
}

// When the supervisor refuses, the motors stay off; service() then gives the lead back to the leader arm before it does
// anything else.
void App::serve(const wire::LeadRequest& request) {
  if (request.lease_ms == 0) return refuse_lead(wire::LeadRefusal::no_lease, 0);
  if (supervisor_.motors_on() && !lead_.on()) return refuse_not_disabled();
  if (!supervisor_.motors_on()) lead_.begin(sampling_);
  if (!granted(supervisor_.enable(request.lease_ms, seen_, distances()))) return;
  wire::LeadReply out;
  out.state = supervisor_.state();
  out.next = lead_.next();
  for (uint8_t i = 0; i < hal::joint_count; ++i) out.reference[i] = lead_.last(i);
  reply(out);
}

void App::serve(const wire::LeadPointRequest& request) {
  const Lead::Verdict verdict = lead_.take(request, sampling_);
  if (verdict.refusal != wire::LeadRefusal::none) return refuse_lead(verdict.refusal, verdict.joint);
  reply(wire::LeadPointReply{lead_.next(), lead_.waiting()});
}

// Switches the drivers as the supervisor has decided. When it has refused, the host is told why.
bool App::granted(const supervisor::Reply& result) {
  using supervisor::Answer;
  follow_supervisor();
  switch (result.answer) {
    case Answer::ok: return true;
    case Answer::booting: refuse(wire::NackCode::booting, 0); break;
    case Answer::in_fault: refuse(wire::NackCode::in_fault, result.detail); break;
    case Answer::pot_bad: refuse(wire::NackCode::pot_bad, pair(result.where, result.detail)); break;
    case Answer::too_far: refuse(wire::NackCode::error_too_large, pair(result.where, coarse(result.detail))); break;
    case Answer::estop: refuse(wire::NackCode::estop_pressed, 0); break;
    case Answer::params:
      if (sets_.unfit().refusal != fuzzy_pdi::Refusal::none) refuse_set();
      else refuse(wire::NackCode::set_lost, 0);
      break;
  }
  return false;
}

void App::serve(const wire::ParamGetRequest& request) {
  int32_t value = 0;
  const params::Access access = params::get(sets_.running(), request.index, value);
  if (access == params::Access::ok) reply(wire::ParamGetReply{request.index, value});
  else refuse(wire::NackCode::bad_index, request.index);
}

void App::serve(const wire::ParamSetRequest& request) {
  switch (sets_.stage(request.index, request.value)) {
    case params::Access::ok: return reply(wire::ParamSetReply{request.index, request.value});
    case params::Access::bad_index: return refuse(wire::NackCode::bad_index, request.index);
    case params::Access::out_of_range: return refuse(wire::NackCode::out_of_range, request.index);
  }
}

void App::serve(const wire::ParamSaveRequest&) {
  sets_.save();
  reply(wire::ParamSaveReply{sets_.crc()});
}

void App::serve(const wire::ParamDefaultsRequest&) {
  sets_.stage_defaults();
  reply(wire::ParamDefaultsReply{});
}

void App::serve(const wire::ParamApplyRequest& request) {
  if (supervisor_.motors_on()) return refuse_not_disabled();
  if (sets_.save_state() == wire::SaveState::saving) return refuse(wire::NackCode::busy_saving, 0);
  sets_.begin_apply(request.crc);
}

// While a set is being applied (a few ms, motors off) no request is taken, so request_ and seq_ are still those of the
// param_apply.
void App::work_on_apply() {
  excused_ = true;
  switch (sets_.work_on_apply(controllers_)) {
    case ParameterSets::Progress::going_on: break;
    case ParameterSets::Progress::crc_differs: refuse(wire::NackCode::crc_mismatch, sets_.staged_crc()); break;
    case ParameterSets::Progress::inconsistent: refuse(wire::NackCode::inconsistent, sets_.misfit()); break;
    case ParameterSets::Progress::no_pins: refuse(wire::NackCode::no_pins, sets_.staged_driver()); break;
    case ParameterSets::Progress::refused: refuse_set(); break;
    case ParameterSets::Progress::applied:
      take_running_set();
      if (sets_.safe() == ParameterSets::Safe::applied) return;  // no host waits for an answer
      sampling_.forget();
      supervisor_.params_mended();
      reply(wire::ParamApplyReply{sets_.crc()});
      break;
  }
}

void App::send_hello(uint8_t seq) {
  wire::HelloReply hello;
  hello.protocol = wire::protocol;
  hello.fw_major = version_major;
  hello.fw_minor = version_minor;
  hello.fw_patch = version_patch;
  hello.schema_hash = wire::schema_hash;
  hello.board = hal::board_id();
  hello.param_crc = sets_.crc();
  hello.param_source = sets_.source();
  hello.reset_cause = hal::reset_cause();
  send(seq, hello);
}

void App::send_status() {
  wire::StatusReply status;
  status.state = supervisor_.state();
  status.stop_reason = supervisor_.stop_reason();
  status.fault = supervisor_.fault();
  status.fault_where = supervisor_.fault_where();
  status.tick = tick_;
  status.late_ticks = late_ticks_;
  status.frames_bad = decoder_.bad();
  status.rx_overruns = rx_overruns_;
  status.telemetry_dropped = telemetry_dropped_;
  status.no_rule = controllers_.no_rule();
  status.tick_us_max = tick_us_max_;
  status.save_state = sets_.save_state();
  status.saves = sets_.saves();
  reply(status);
}

void App::send_sample() {
  sample_due_ = false;
  wire::Sample sample;
  sample.tick = tick_;
  sample.state = supervisor_.state();
  sample.fault = supervisor_.fault();
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    // When the host leads, sampling_.leader() is already that of the next tick.
    sample.leader[i] = lead_.on() ? sampling_.reference(i) : sampling_.leader(i);
    sample.follower[i] = sampling_.follower(i);
    sample.voltage[i] = controllers_.volts_mv(i);
  }
  send(sample_seq_, sample);
}

void App::refuse_not_disabled() { refuse(wire::NackCode::not_disabled, static_cast<uint8_t>(supervisor_.state())); }

void App::refuse_lead(wire::LeadRefusal why, uint8_t joint) {
  refuse(wire::NackCode::lead_refused, pair(joint, static_cast<uint8_t>(why)));
}

void App::refuse_set() {
  const Unfit unfit = sets_.unfit();
  refuse(wire::NackCode::set_refused, pair(unfit.joint, static_cast<uint8_t>(unfit.refusal)));
}

void App::refuse(wire::NackCode code, uint16_t detail) { reply(wire::Nack{request_, code, detail}); }

// The ring has room: service() has checked that the largest frame fits.
template <class Message>
void App::send(uint8_t seq, const Message& message) {
  encoder_.encode(seq, message);
  hal::tx_write(encoder_.data(), encoder_.size());
}

}  // namespace app
