// See lead.h.
#ifdef __AVR__
#pragma GCC optimize("Os")  // between ticks there is time, and flash is short
#endif
#include "lead.h"

#include <string.h>

namespace app {
namespace {

constexpr int16_t q12_per_step = 4;
constexpr int32_t q27_per_tick = 32768L * q12_per_step / 512;  // of a speed of 1

}  // namespace

void Lead::begin(Sampling& sampling) {
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    last_[i] = sampling.within_limits(i, sampling.follower(i));
    sampling.lead(i, last_[i]);
  }
  memset(after_, 0, sizeof after_);
  waiting_ = 0;
  done_ = ticks_per_point;
  on_ = true;
}

Lead::Verdict Lead::take(const wire::LeadPointRequest& point, const Sampling& sampling) {
  using wire::LeadRefusal;
  if (!on_) return {LeadRefusal::not_leading, 0};
  if (point.number != next_ || waiting_ == room) return {LeadRefusal::none, 0};
  int16_t angle[hal::joint_count] = {};
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    angle[i] = static_cast<int16_t>(last_[i] + point.step[i] * q12_per_step);
    if (sampling.within_limits(i, angle[i]) != angle[i]) return {LeadRefusal::limit, i};
  }
  memcpy(last_, angle, sizeof last_);
  memcpy(steps_[(first_ + waiting_) % room], point.step, sizeof(Step));
  ++waiting_;
  ++next_;
  return {LeadRefusal::none, 0};
}

void Lead::begin_piece() {
  memcpy(before_, after_, sizeof before_);
  done_ = 0;
  if (waiting_ == 0) {
    memset(after_, 0, sizeof after_);
    return;
  }
  memcpy(after_, steps_[first_], sizeof after_);
  first_ = static_cast<uint8_t>((first_ + 1) % room);
  --waiting_;
}

// A piece of the curve leads from the middle of one step to the middle of the next. Its speed changes evenly from that
// of the first step to that of the second. Its tick n = 0..15 moves the reference by (32 before + (2 n + 1)(after -
// before)) / 512. The sum of all is exactly (before + after) / 2, so nothing is lost.
void Lead::advance(Sampling& sampling) {
  if (done_ == ticks_per_point) begin_piece();
  const auto share = static_cast<int16_t>(2 * done_ + 1);
  ++done_;
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    const auto bend = static_cast<int16_t>(after_[i] - before_[i]);
    const auto speed = static_cast<int16_t>(32 * before_[i] + share * bend);  // 2^-9 steps a tick
    if (speed != 0) sampling.move_lead(i, speed * q27_per_tick);
  }
}

}  // namespace app
