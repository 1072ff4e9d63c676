// See unrest.h.
#include "unrest.h"

namespace supervisor {
namespace {

// Angles may be anywhere within 16 bits. What has moved by more than 8 rad at once is taken for less, and no arm does.
int16_t between(int16_t from, int16_t to) {
  return static_cast<int16_t>(static_cast<uint16_t>(static_cast<uint16_t>(to) - static_cast<uint16_t>(from)));
}

uint8_t coarse(int16_t angle_q12) { return static_cast<uint8_t>(angle_q12 >> 4); }

}  // namespace

void Unrest::configure(const UnrestLimits& limits) {
  amplitude_ = limits.amplitude;
  slot_looks_ = static_cast<uint8_t>((looks_per_second + limits.rate - 1) / limits.rate);
  slots_ = static_cast<uint8_t>((limits.time * limits.rate + 9) / 10);
}

void Unrest::forget() {
  for (uint8_t joint = 0; joint < joint_count; ++joint) forget(joint);
}

void Unrest::forget(uint8_t joint) {
  joints_[joint].slots = 0;
  joints_[joint].largest = joints_[joint].before = 0;
}

bool Unrest::look(uint8_t joint, int16_t reference, int16_t error) {
  if (amplitude_ == 0) return false;
  if (joint == 0 && ++look_ >= slot_looks_) look_ = 0;
  Joint& seen = joints_[joint];
  follow(seen, error);
  const int16_t moved = between(seen.leader, reference);
  const auto still = static_cast<int16_t>(4 * amplitude_);  // q12 rad
  const bool leader_moves = moved > still || moved < -still;
  if (leader_moves) forget();
  if (leader_moves || look_ == 0) seen.leader = reference;
  if (look_ != 0) return false;
  end_slot(seen);
  return seen.slots > slots_;
}

void Unrest::follow(Joint& joint, int16_t error) const {
  const int16_t change = between(joint.farthest, error);
  const int16_t back = joint.rising ? between(change, 0) : change;
  const auto swing = static_cast<int16_t>(8 * amplitude_);  // q12 rad
  if (back > 0 && back <= swing) return;
  if (back > 0) {
    const uint8_t turn = coarse(joint.farthest);
    const auto size = static_cast<uint8_t>(joint.rising ? turn - joint.turn : joint.turn - turn);
    if (size > joint.largest) joint.largest = size;
    if (joint.largest == 0) joint.largest = 1;
    joint.turn = turn;
    joint.rising = !joint.rising;
  }
  joint.farthest = error;
}

void Unrest::end_slot(Joint& joint) {
  const uint8_t largest = joint.largest;
  const bool dies_away = largest < joint.before / 2;
  joint.largest = 0;
  if (largest == 0 || dies_away) {
    joint.slots = 0;
    joint.before = 0;
  }
  if (largest == 0) return;
  joint.slots = (joint.slots + 1u) & 0x7f;
  if (largest > joint.before) joint.before = largest;
}

}  // namespace supervisor
