// See host.h.
#include "host.h"

namespace attack {

Host::Host(Random& random) : random_(random), wanted_(), staged_(), request_() {
  params::load_defaults(wanted_);
  staged_ = wanted_;
}

template <class Request>
void Host::say(const Request& request) {
  request_ = make_frame(++seq_, request);
}

const Frame& Host::request() {
  if (answered_) next();
  answered_ = false;
  return request_;
}

std::vector<std::vector<std::uint8_t>> Host::messages() {
  const std::vector<std::uint8_t> bytes = encode(request());
  if (request_.type == wire::StopRequest::type) return {{0}, bytes, {0}, bytes};
  return {bytes};
}

void Host::next() {
  if (uploads_) next_of_upload();
  else next_of_motion();
}

// Value by value, then all at once, then into the EEPROM at times. What is staged already is not sent again.
void Host::next_of_upload() {
  for (; at_ < params::count; ++at_) {
    std::int32_t value = 0, there = 0;
    params::get(wanted_, at_, value);
    params::get(staged_, at_, there);
    if (all_again_ || value != there) return say(wire::ParamSetRequest{at_++, value});
  }
  all_again_ = false;
  if (at_++ == params::count) return say(wire::ParamApplyRequest{params::crc(wanted_)});
  uploads_ = false;
  left_ = static_cast<int>(between(random_, 5, 60));
  leads_ = between(random_, 0, 1);
  if (between(random_, 0, 3) == 0) return say(wire::ParamSaveRequest{});
  next_of_motion();
}

void Host::next_of_motion() {
  const auto lease = static_cast<std::uint16_t>(between(random_, 100, 2000));
  if (left_-- == 0) {
    uploads_ = true;
    at_ = 0;
    for (int i = 0; i < 3; ++i) {
      const auto joint = static_cast<std::size_t>(between(random_, 0, 3));
      wanted_.joint[joint].ku_mv = static_cast<std::uint16_t>(between(random_, 0, 30000));
      wanted_.joint[joint].kp = static_cast<std::uint32_t>(between(random_, 0, 4194304));
    }
    return say(wire::StopRequest{});
  }
  wire::LeadPointRequest point = {next_point_, {}};
  for (std::int8_t& step : point.step) step = static_cast<std::int8_t>(between(random_, -20, 20));
  switch (between(random_, 0, 7)) {
    case 0: return say(wire::StatusRequest{});
    case 1: return say(wire::ClearFaultRequest{});
    case 2: return say(wire::RenewRequest{lease});
    case 3: return say(wire::ParamGetRequest{static_cast<std::uint16_t>(between(random_, 0, params::count - 1))});
    case 4: return say(wire::TelemetryRequest{static_cast<std::uint16_t>(between(random_, 0, 20))});
    case 5: return leads_ ? say(wire::LeadRequest{lease}) : say(wire::EnableRequest{lease});
    default: return leads_ ? say(point) : say(wire::HelloRequest{});
  }
}

void Host::hear(const Frame& reply) {
  if (reply.seq != request_.seq) return;
  wire::Nack nack;
  const bool refused = reply.read(nack);
  if (!refused && reply.type != (request_.type | wire::reply_bit)) return;
  answered_ = true;
  wire::ParamSetReply set;
  wire::LeadReply lead;
  wire::LeadPointReply point;
  if (reply.read(set)) params::set(staged_, set.index, set.value);
  if (reply.read(lead)) next_point_ = lead.next;
  if (reply.read(point)) next_point_ = point.next;
  if (!refused || nack.request != wire::ParamApplyRequest::type) return;
  at_ = 0;
  all_again_ = nack.code == wire::NackCode::crc_mismatch;  // another set is staged than this host has sent
}

}  // namespace attack
