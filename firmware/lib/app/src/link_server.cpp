// See link_server.h.
#ifdef __AVR__
#pragma GCC optimize("Os")  // between ticks there is time, and flash is short
#endif

#include "link_server.h"

#include <hal.h>

#include "counting.h"
#include "version.h"

namespace app {
namespace {

constexpr uint8_t bytes_per_piece = 20;

// A distance in 1/32 rad, as error_too_large carries it.
uint8_t coarse(uint16_t distance_q12) {
  const uint16_t steps = static_cast<uint16_t>((distance_q12 + 64UL) >> 7);
  return steps > 255 ? uint8_t{255} : static_cast<uint8_t>(steps);
}

uint16_t pair(uint8_t high, uint16_t low) { return static_cast<uint16_t>(high << 8 | (low & 0xff)); }

}  // namespace

// A sample is dropped when it could not be sent before the next one is due. Its sequence number is then never sent.
void LinkServer::schedule_sample() {
  if (every_ == 0 || --until_sample_) return;
  until_sample_ = every_;
  ++sample_seq_;
  if (sample_due_) telemetry_dropped_ = add_saturated(telemetry_dropped_, 1);
  sample_due_ = true;
}

void LinkServer::note_lost_bytes(Tick& tick) {
  const uint8_t lost = hal::rx_lost();
  if (lost == 0) return;
  rx_overruns_ = add_saturated(rx_overruns_, lost);
  tick.note_lost_bytes();
}

bool LinkServer::send_due(const Tick& tick) {
  if (sample_due_) {
    send_sample(tick);
    return true;
  }
  if (hello_sent_ || tick.supervisor().state() == supervisor::State::boot) return false;
  hello_sent_ = true;
  const uint8_t end = 0;  // of a frame that was being sent when the supply was cut: it would swallow this one
  hal::tx_write(&end, 1);
  send_hello(0, tick);  // without a request: the host waits for the bootloader to end
  return true;
}

void LinkServer::receive(Tick& tick) {
  for (uint8_t left = bytes_per_piece; left && hal::rx_available(); --left) {
    if (decoder_.push(hal::rx_read())) return handle_frame(tick);
  }
}

// One case for each declared request and no default, so that the compiler names a request without a case (-Wswitch).
void LinkServer::handle_frame(Tick& tick) {
  switch (static_cast<wire::RequestType>(decoder_.type())) {
    case wire::RequestType::hello: return handle<wire::HelloRequest>(tick);
    case wire::RequestType::status: return handle<wire::StatusRequest>(tick);
    case wire::RequestType::param_get: return handle<wire::ParamGetRequest>(tick);
    case wire::RequestType::param_set: return handle<wire::ParamSetRequest>(tick);
    case wire::RequestType::param_apply: return handle<wire::ParamApplyRequest>(tick);
    case wire::RequestType::param_save: return handle<wire::ParamSaveRequest>(tick);
    case wire::RequestType::param_defaults: return handle<wire::ParamDefaultsRequest>(tick);
    case wire::RequestType::enable: return handle<wire::EnableRequest>(tick);
    case wire::RequestType::stop: return handle<wire::StopRequest>(tick);
    case wire::RequestType::renew: return handle<wire::RenewRequest>(tick);
    case wire::RequestType::clear_fault: return handle<wire::ClearFaultRequest>(tick);
    case wire::RequestType::telemetry: return handle<wire::TelemetryRequest>(tick);
    case wire::RequestType::lead: return handle<wire::LeadRequest>(tick);
    case wire::RequestType::lead_point: return handle<wire::LeadPointRequest>(tick);
    case wire::RequestType::clutch: return handle<wire::ClutchRequest>(tick);
  }
  refuse(wire::NackCode::unknown_type, decoder_.type());
}

template <class Request>
void LinkServer::handle(Tick& tick) {
  Request request;
  if (Request::decode(decoder_.payload(), decoder_.payload_size(), request)) return serve(request, tick);
  refuse(wire::NackCode::bad_length, decoder_.payload_size());
}

void LinkServer::serve(const wire::HelloRequest&, const Tick& tick) { send_hello(decoder_.seq(), tick); }

void LinkServer::serve(const wire::TelemetryRequest& request, const Tick&) {
  every_ = until_sample_ = request.every;
  sample_due_ = false;
  reply(wire::TelemetryReply{request.every});
}

void LinkServer::serve(const wire::EnableRequest& request, Tick& tick) {
  // While the host leads, the leader arm cannot take over: it may be anywhere.
  if (tick.lead().on()) return refuse_not_disabled(tick);
  if (refuse_unless_granted(tick.enable(request.lease_ms), tick)) reply(wire::EnableReply{tick.supervisor().state()});
}

void LinkServer::serve(const wire::StopRequest&, Tick& tick) {
  tick.stop();
  reply(wire::StopReply{tick.supervisor().state()});
}

void LinkServer::serve(const wire::RenewRequest& request, Tick& tick) {
  // Without a lease the motors would hold the arm for ever after the host has gone.
  if (tick.lead().on() && request.lease_ms == 0) return refuse_lead(wire::LeadRefusal::no_lease, 0);
  tick.renew(request.lease_ms);
  reply(wire::RenewReply{tick.supervisor().state()});
}

void LinkServer::serve(const wire::ClearFaultRequest&, Tick& tick) {
  if (refuse_unless_granted(tick.clear_fault(), tick)) reply(wire::ClearFaultReply{tick.supervisor().state()});
}

void LinkServer::serve(const wire::LeadRequest& request, Tick& tick) {
  if (request.lease_ms == 0) return refuse_lead(wire::LeadRefusal::no_lease, 0);
  if (tick.supervisor().motors_on() && !tick.lead().on()) return refuse_not_disabled(tick);
  if (!refuse_unless_granted(tick.enable_with_host_leading(request.lease_ms), tick)) return;
  wire::LeadReply out;
  out.state = tick.supervisor().state();
  out.next = tick.lead().next();
  for (uint8_t i = 0; i < hal::joint_count; ++i) out.reference[i] = tick.lead().last(i);
  reply(out);
}

void LinkServer::serve(const wire::LeadPointRequest& request, Tick& tick) {
  const Lead::Verdict verdict = tick.take_point(request);
  if (verdict.refusal != wire::LeadRefusal::none) return refuse_lead(verdict.refusal, verdict.joint);
  reply(wire::LeadPointReply{tick.lead().next(), tick.lead().waiting()});
}

void LinkServer::serve(const wire::ClutchRequest& request, Tick& tick) {
  if (request.action == wire::ClutchAction::reset) {
    if (tick.supervisor().motors_on()) return refuse_not_disabled(tick);
    tick.reset_clutch();
  } else {
    tick.use_clutch(request.action != wire::ClutchAction::engage);
  }
  reply(wire::ClutchReply{tick.clutch()});
}

// Sends the reason of a refusal. True where there was none.
bool LinkServer::refuse_unless_granted(const supervisor::Reply& result, const Tick& tick) {
  if (result.refusal == wire::NackCode::none) return true;
  const bool unfit = tick.sets().unfit().refusal != fuzzy_pdi::Refusal::none;
  uint16_t detail = result.detail;
  if (result.refusal == wire::NackCode::error_too_large) detail = coarse(detail);
  if (result.where != supervisor::nowhere) detail = pair(result.where, detail);
  if (result.refusal == wire::NackCode::set_lost && unfit) refuse_set(tick);
  else refuse(result.refusal, detail);
  return false;
}

void LinkServer::serve(const wire::ParamGetRequest& request, const Tick& tick) {
  int32_t value = 0;
  const params::Access access = params::get(tick.sets().running(), request.index, value);
  if (access == params::Access::ok) reply(wire::ParamGetReply{request.index, value});
  else refuse(wire::NackCode::bad_index, request.index);
}

void LinkServer::serve(const wire::ParamSetRequest& request, Tick& tick) {
  switch (tick.sets().stage(request.index, request.value)) {
    case params::Access::ok: return reply(wire::ParamSetReply{request.index, request.value});
    case params::Access::bad_index: return refuse(wire::NackCode::bad_index, request.index);
    case params::Access::out_of_range: return refuse(wire::NackCode::out_of_range, request.index);
  }
}

void LinkServer::serve(const wire::ParamSaveRequest&, Tick& tick) {
  tick.sets().save();
  reply(wire::ParamSaveReply{tick.sets().crc()});
}

void LinkServer::serve(const wire::ParamDefaultsRequest&, Tick& tick) {
  tick.sets().stage_defaults();
  reply(wire::ParamDefaultsReply{});
}

void LinkServer::serve(const wire::ParamApplyRequest& request, Tick& tick) {
  if (tick.supervisor().motors_on()) return refuse_not_disabled(tick);
  if (tick.sets().save_state() == wire::SaveState::saving) return refuse(wire::NackCode::busy_saving, 0);
  tick.sets().begin_apply(request.crc);
}

// It takes a few ms, with the motors off. No request is taken meanwhile, so the answer goes to the param_apply.
void LinkServer::apply(Tick& tick) {
  switch (tick.apply_step()) {
    case ParameterSets::Progress::going_on: break;
    case ParameterSets::Progress::crc_differs: refuse(wire::NackCode::crc_mismatch, tick.sets().staged_crc()); break;
    case ParameterSets::Progress::inconsistent: refuse(wire::NackCode::inconsistent, tick.sets().misfit()); break;
    case ParameterSets::Progress::no_pins: refuse(wire::NackCode::no_pins, tick.sets().staged_driver()); break;
    case ParameterSets::Progress::refused: refuse_set(tick); break;
    case ParameterSets::Progress::applied:
      if (tick.sets().safe() == ParameterSets::Safe::applied) return;  // no host waits for an answer
      reply(wire::ParamApplyReply{tick.sets().crc()});
      break;
  }
}

void LinkServer::send_hello(uint8_t seq, const Tick& tick) {
  wire::HelloReply hello;
  hello.protocol = wire::protocol;
  hello.fw_major = version_major;
  hello.fw_minor = version_minor;
  hello.fw_patch = version_patch;
  hello.schema_hash = wire::schema_hash;
  hello.board = hal::board_id();
  hello.param_crc = tick.sets().crc();
  hello.param_source = tick.sets().source();
  hello.reset_cause = hal::reset_cause();
  send(seq, hello);
}

void LinkServer::serve(const wire::StatusRequest&, const Tick& tick) {
  wire::StatusReply status;
  status.state = tick.supervisor().state();
  status.stop_reason = tick.supervisor().stop_reason();
  status.fault = tick.supervisor().fault();
  status.fault_where = tick.supervisor().fault_where();
  status.tick = tick.number();
  status.late_ticks = tick.late_ticks();
  status.frames_bad = decoder_.bad();
  status.rx_overruns = rx_overruns_;
  status.telemetry_dropped = telemetry_dropped_;
  status.no_rule = tick.controllers().no_rule();
  status.tick_us_max = tick.longest_us();
  status.clutch = tick.clutch();
  status.save_state = tick.sets().save_state();
  status.saves = tick.sets().saves();
  reply(status);
}

void LinkServer::send_sample(const Tick& tick) {
  sample_due_ = false;
  wire::Sample sample;
  sample.tick = tick.number();
  sample.state = tick.supervisor().state();
  sample.fault = tick.supervisor().fault();
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    sample.leader[i] = tick.leader(i);
    sample.follower[i] = tick.sampling().follower(i);
    sample.voltage[i] = tick.controllers().volts_mv(i);
  }
  send(sample_seq_, sample);
}

void LinkServer::refuse_not_disabled(const Tick& tick) {
  refuse(wire::NackCode::not_disabled, static_cast<uint8_t>(tick.supervisor().state()));
}

void LinkServer::refuse_lead(wire::LeadRefusal why, uint8_t joint) {
  refuse(wire::NackCode::lead_refused, pair(joint, static_cast<uint8_t>(why)));
}

void LinkServer::refuse_set(const Tick& tick) {
  const Unfit unfit = tick.sets().unfit();
  refuse(wire::NackCode::set_refused, pair(unfit.joint, static_cast<uint8_t>(unfit.refusal)));
}

void LinkServer::refuse(wire::NackCode code, uint16_t detail) { reply(wire::Nack{decoder_.type(), code, detail}); }

// The ring has room: can_reply() has said that the largest frame fits.
template <class Message>
void LinkServer::send(uint8_t seq, const Message& message) {
  message.encode(encoder_.payload());
  finish(seq, Message::type, Message::size);
}

__attribute__((noinline)) void LinkServer::finish(uint8_t seq, uint8_t type, uint8_t size) {
  encoder_.finish(type, seq, size);
  hal::tx_write(encoder_.data(), encoder_.size());
}

}  // namespace app
