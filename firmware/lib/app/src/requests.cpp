// The link's half of App: requests, replies and samples, one bounded piece at a time.
#include <hal.h>

#include "app.h"
#include "version.h"

namespace app {
namespace {

// A piece of work is not begun this late in a tick, so that the next tick starts in time even while bytes pour in.
constexpr uint16_t latest_start_us = 800;
constexpr uint16_t latest_apply_us = 300;   // a joint's compilation takes most of a tick
constexpr uint8_t bytes_per_piece = 16;

// Farther than two angles can be apart: with it no tick has judged the pots by the running set yet.
constexpr uint16_t not_seen = UINT16_MAX;

// The supervisor and the parts below it know nothing of the link; their numbers are the link's all the same.
template <class A, class B>
constexpr bool same(A a, B b) { return static_cast<uint8_t>(a) == static_cast<uint8_t>(b); }
static_assert(same(supervisor::State::fault, wire::State::fault) && same(supervisor::State::boot, wire::State::boot) &&
         same(supervisor::State::soft_start, wire::State::soft_start),
       "states");
static_assert(same(supervisor::Fault::params, wire::Fault::params) &&
         same(supervisor::Fault::pot_low, wire::Fault::pot_low) &&
         same(supervisor::Fault::tracking, wire::Fault::tracking),
       "faults");
static_assert(same(supervisor::StopReason::reset, wire::StopReason::reset) &&
         same(supervisor::StopReason::host, wire::StopReason::host),
       "stop reasons");
static_assert(same(hal::ResetCause::watchdog, wire::ResetCause::watchdog) &&
         same(hal::ResetCause::external, wire::ResetCause::external),
       "reset causes");
static_assert(same(hal::Board::native, wire::Board::native) && same(hal::Board::mega2560, wire::Board::mega2560),
       "boards");
static_assert(same(fuzzy_pdi::Refusal::period, wire::Refusal::period) &&
         same(fuzzy_pdi::Refusal::order, wire::Refusal::order),
       "refusals");

wire::State on_link(supervisor::State state) { return static_cast<wire::State>(state); }

// |error| in 1/32 rad, as error_too_large carries it
uint8_t coarse(uint16_t distance_q12) {
  const uint16_t steps = static_cast<uint16_t>((distance_q12 + 64UL) >> 7);
  return steps > 255 ? uint8_t{255} : static_cast<uint8_t>(steps);
}

uint16_t pair(uint8_t high, uint16_t low) { return static_cast<uint16_t>(high << 8 | (low & 0xff)); }

}  // namespace

bool App::service() {
  if (lead_.on() && work_on_lead()) return true;
  const uint16_t age_us = hal::tick_age_us();
  const bool late_in_tick = age_us > latest_start_us;
  if (late_in_tick && heard_this_tick_) return false;
  const uint8_t lost = hal::rx_lost();
  if (lost) rx_overruns_ = rx_overruns_ > UINT16_MAX - lost ? UINT16_MAX : static_cast<uint16_t>(rx_overruns_ + lost);
  if (hal::tx_free() < wire::max_wire) return false;   // what waits stays where it is until there is room to answer
  if (sets_.applying()) {
    if (age_us > latest_apply_us) return false;
    work_on_apply();
    return true;
  }
  if (excused_) return false;   // an enable must be judged by what a tick has seen with the new set
  if (!heard_this_tick_ && hal::rx_available()) {
    receive();   // at least once a tick, whatever else there is: a stop must get through
    return true;
  }
  if (late_in_tick) return false;
  if (sample_due_) {
    send_sample();
  } else if (hello_due_) {
    hello_due_ = false;
    send_hello(0);   // unasked, so that a host that waits for the bootloader to end can go on
  } else if (hal::rx_available()) {
    receive();
  } else {
    return sets_.work_on_save();
  }
  return true;
}

// Once a tick, before anything else: moves the host's reference on. Once the motors are off, for whatever reason, the leader arm leads
// again, and no request is taken before that.
bool App::work_on_lead() {
  const auto tick = static_cast<uint8_t>(tick_);
  if (drivers_on_) {
    if (!lead_.due(tick)) return false;
    lead_.advance(tick, sampling_);
    return true;
  }
  lead_.end();
  sampling_.configure(sets_.running());
  see_distances();
  return true;
}

void App::see_distances() {
  for (uint8_t i = 0; i < hal::joint_count; ++i) seen_.distance[i] = sampling_.distance(i);
}

void App::receive() {
  heard_this_tick_ = true;
  for (uint8_t left = bytes_per_piece; left && hal::rx_available(); --left) {
    if (decoder_.push(hal::rx_read())) return handle_frame();
  }
}

void App::handle_frame() {
  request_ = decoder_.type();
  seq_ = decoder_.seq();
  switch (request_) {
    case wire::HelloRequest::type: {
      wire::HelloRequest request;
      if (decode(request)) send_hello(seq_);
      break;
    }
    case wire::StatusRequest::type: {
      wire::StatusRequest request;
      if (decode(request)) send_status();
      break;
    }
    case wire::TelemetryRequest::type: {
      wire::TelemetryRequest request;
      if (!decode(request)) break;
      every_ = until_sample_ = request.every;
      sample_due_ = false;
      reply(wire::TelemetryReply{request.every});
      break;
    }
    case wire::ParamGetRequest::type:
    case wire::ParamSetRequest::type:
    case wire::ParamApplyRequest::type:
    case wire::ParamSaveRequest::type:
    case wire::ParamDefaultsRequest::type: handle_parameters(request_); break;
    case wire::EnableRequest::type:
    case wire::StopRequest::type:
    case wire::RenewRequest::type:
    case wire::ClearFaultRequest::type:
    case wire::LeadRequest::type:
      handle_motors(request_);
      follow_supervisor();
      break;
    case wire::LeadPointRequest::type: handle_lead_point(); break;
    default: refuse(wire::NackCode::unknown_type, request_); break;
  }
}

void App::handle_motors(uint8_t type) {
  switch (type) {
    case wire::EnableRequest::type: {
      wire::EnableRequest request;
      if (!decode(request)) break;
      // While the host leads the leader arm cannot take over: it may be anywhere.
      if (lead_.on()) return refuse(wire::NackCode::not_disabled, static_cast<uint8_t>(supervisor_.state()));
      answer(supervisor_.enable(request.lease_ms, seen_));
      break;
    }
    case wire::StopRequest::type: {
      wire::StopRequest request;
      if (!decode(request)) break;
      supervisor_.stop();
      reply(wire::StopReply{on_link(supervisor_.state())});
      break;
    }
    case wire::RenewRequest::type: {
      wire::RenewRequest request;
      if (!decode(request)) break;
      if (lead_.on() && request.lease_ms == 0) {   // would hold the arm for ever with nobody leading it
        return refuse(wire::NackCode::lead_refused, pair(0, static_cast<uint8_t>(wire::LeadRefusal::no_lease)));
      }
      supervisor_.renew(request.lease_ms);
      reply(wire::RenewReply{on_link(supervisor_.state())});
      break;
    }
    case wire::LeadRequest::type: handle_lead(); break;
    default: {
      wire::ClearFaultRequest request;
      if (decode(request)) answer(supervisor_.clear_fault(seen_));
      break;
    }
  }
}

// When it is refused the motors stay off, and the leader arm leads again before anything else is done.
void App::handle_lead() {
  wire::LeadRequest request;
  if (!decode(request)) return;
  if (request.lease_ms == 0) return refuse(wire::NackCode::lead_refused, pair(0, static_cast<uint8_t>(wire::LeadRefusal::no_lease)));
  if (supervisor_.motors_on() && !lead_.on()) {
    return refuse(wire::NackCode::not_disabled, static_cast<uint8_t>(supervisor_.state()));
  }
  if (!supervisor_.motors_on()) {
    lead_.begin(sampling_);
    see_distances();
  }
  answer(supervisor_.enable(request.lease_ms, seen_));
}

void App::handle_lead_point() {
  wire::LeadPointRequest request;
  if (!decode(request)) return;
  const Lead::Verdict verdict = lead_.take(request, sampling_);
  if (verdict.refusal != wire::LeadRefusal::none) {
    return refuse(wire::NackCode::lead_refused, pair(verdict.joint, static_cast<uint8_t>(verdict.refusal)));
  }
  reply(wire::LeadPointReply{lead_.next(), lead_.waiting()});
}

void App::reply_lead() {
  wire::LeadReply out;
  out.state = on_link(supervisor_.state());
  out.next = lead_.next();
  for (uint8_t i = 0; i < hal::joint_count; ++i) out.reference[i] = lead_.last(i);
  reply(out);
}

// The answer to enable, lead and clear_fault.
void App::answer(const supervisor::Reply& result) {
  using supervisor::Answer;
  switch (result.answer) {
    case Answer::ok:
      if (request_ == wire::EnableRequest::type) reply(wire::EnableReply{on_link(supervisor_.state())});
      else if (request_ == wire::LeadRequest::type) reply_lead();
      else reply(wire::ClearFaultReply{on_link(supervisor_.state())});
      break;
    case Answer::booting: refuse(wire::NackCode::booting, 0); break;
    case Answer::in_fault: refuse(wire::NackCode::in_fault, result.detail); break;
    case Answer::pot_bad: refuse(wire::NackCode::pot_bad, pair(result.where, result.detail)); break;
    case Answer::too_far:
      refuse(wire::NackCode::error_too_large, pair(result.where, coarse(result.detail)));
      break;
    case Answer::params: refuse_set(); break;
  }
}

void App::handle_parameters(uint8_t type) {
  switch (type) {
    case wire::ParamGetRequest::type: {
      wire::ParamGetRequest request;
      int32_t value = 0;
      if (!decode(request)) break;
      const params::Access access = params::get(sets_.running(), request.index, value);
      if (access == params::Access::bad_index) refuse(wire::NackCode::bad_index, request.index);
      else reply(wire::ParamGetReply{request.index, value});
      break;
    }
    case wire::ParamSetRequest::type: {
      wire::ParamSetRequest request;
      if (!decode(request)) break;
      const params::Access access = sets_.stage(request.index, request.value);
      if (access == params::Access::bad_index) refuse(wire::NackCode::bad_index, request.index);
      else if (access == params::Access::out_of_range) refuse(wire::NackCode::out_of_range, request.index);
      else reply(wire::ParamSetReply{request.index, request.value});
      break;
    }
    case wire::ParamApplyRequest::type: {
      wire::ParamApplyRequest request;
      if (decode(request)) begin_apply(request.crc);
      break;
    }
    case wire::ParamSaveRequest::type: {
      wire::ParamSaveRequest request;
      if (!decode(request)) break;
      sets_.save();
      reply(wire::ParamSaveReply{sets_.crc()});
      break;
    }
    default: {
      wire::ParamDefaultsRequest request;
      if (!decode(request)) break;
      sets_.stage_defaults();
      reply(wire::ParamDefaultsReply{});
      break;
    }
  }
}

void App::begin_apply(uint16_t crc) {
  if (supervisor_.motors_on()) return refuse(wire::NackCode::not_disabled, static_cast<uint8_t>(supervisor_.state()));
  if (sets_.save_state() == wire::SaveState::saving) return refuse(wire::NackCode::busy_saving, 0);
  sets_.begin_apply(crc);
}

// No request is taken while a set is being applied (a few ms, motors off), so request_ and seq_ still are those of
// the param_apply.
void App::work_on_apply() {
  excused_ = true;
  switch (sets_.work_on_apply(controllers_)) {
    case ParameterSets::Progress::going_on: break;
    case ParameterSets::Progress::crc_differs: refuse(wire::NackCode::crc_mismatch, sets_.staged_crc()); break;
    case ParameterSets::Progress::inconsistent: refuse(wire::NackCode::inconsistent, sets_.misfit()); break;
    case ParameterSets::Progress::refused: refuse_set(); break;
    case ParameterSets::Progress::applied:
      take_running_set();
      for (uint16_t& distance : seen_.distance) distance = not_seen;
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
  hello.board = static_cast<wire::Board>(hal::board_id());
  hello.param_crc = sets_.crc();
  hello.param_source = sets_.source();
  hello.reset_cause = static_cast<wire::ResetCause>(hal::reset_cause());
  send(seq, hello);
}

void App::send_status() {
  wire::StatusReply status;
  status.state = on_link(supervisor_.state());
  status.stop_reason = static_cast<wire::StopReason>(supervisor_.stop_reason());
  status.fault = static_cast<wire::Fault>(supervisor_.fault());
  status.fault_where = supervisor_.fault_where();
  status.tick = tick_;
  status.late_ticks = late_ticks_;
  status.frames_bad = decoder_.bad();
  status.rx_overruns = rx_overruns_;
  status.telemetry_dropped = telemetry_dropped_;
  status.no_rule = controllers_.no_rule();
  status.tick_us_max = tick_us_max_;
  status.save_state = sets_.save_state();
  reply(status);
}

void App::send_sample() {
  sample_due_ = false;
  wire::Sample sample;
  sample.tick = tick_;
  sample.state = on_link(supervisor_.state());
  sample.fault = static_cast<wire::Fault>(supervisor_.fault());
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    // A led reference is already the next tick's; the controllers' own error tells what this tick's was.
    sample.leader[i] =
        lead_.on() ? static_cast<int16_t>(sampling_.follower(i) + sampling_.error(i)) : sampling_.leader(i);
    sample.follower[i] = sampling_.follower(i);
    sample.voltage[i] = controllers_.volts_mv(i);
  }
  send(sample_seq_, sample);
}

void App::refuse_set() {
  const Unfit unfit = sets_.unfit();
  refuse(wire::NackCode::set_refused, pair(unfit.joint, static_cast<uint8_t>(unfit.refusal)));
}

void App::refuse(wire::NackCode code, uint16_t detail) { reply(wire::Nack{request_, code, detail}); }

template <class Request>
bool App::decode(Request& request) {
  if (Request::decode(decoder_.payload(), decoder_.payload_size(), request)) return true;
  refuse(wire::NackCode::bad_length, decoder_.payload_size());
  return false;
}

// service() has seen to it that the ring has room for the largest frame.
template <class Message>
void App::send(uint8_t seq, const Message& message) {
  encoder_.encode(seq, message);
  hal::tx_write(encoder_.data(), encoder_.size());
}

}  // namespace app
