// See person.h.
#include "person.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace greywhale::bench {
namespace {

// A critically damped pull (1/s): nine tenths of a short way take 0.16 s. No hand turns a joint faster (rad/s).
constexpr double kPull = 25.0, kFastest = 5.0;

std::uint64_t slices(double seconds, double slice) {
  return static_cast<std::uint64_t>(std::max(1.0, std::nearbyint(seconds / slice)));
}

Four between(const Four& start, const Four& end, double share) {
  Four pose{};
  for (std::size_t i = 0; i < pose.size(); ++i) pose[i] = start[i] + share * (end[i] - start[i]);
  return pose;
}

}  // namespace

Motion still_motion(const Four& pose) {
  return {1, [pose](std::uint64_t, std::vector<Four>& piece) { std::fill(piece.begin(), piece.end(), pose); }};
}

void StreamedLeader::step(double slice) {
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    const double pull = kPull * kPull * (target[i] - angles_[i]) - 2.0 * kPull * speeds_[i];
    speeds_[i] = std::clamp(speeds_[i] + slice * pull, -kFastest, kFastest);
    angles_[i] += slice * speeds_[i];
  }
}

Person::Person(Motion motion, double slice, double start, unsigned in_use)
    : slice_(slice),
      start_(slices(start, slice)),
      let_go_(slices(kLetGo, slice)),
      bring_back_(slices(kBringBack, slice)),
      off_(let_go_ + bring_back_),
      way_(bring_back_) {
  for (std::size_t joint = 0; joint < in_use_.size(); ++joint) in_use_[joint] = in_use >> joint & 1u;
  learn(std::move(motion));
  left_at_ = rest_ = {home_, home_};
  angles_ = taken_at_ = home_;
  hold = home_;
}

void Person::take_up(Motion motion) {
  streamed_.reset();
  learn(std::move(motion));
  rest_ = {home_, home_};
  further_.clear();
  if (hold) set_out(bring_back_);
  else if (on_ > 0) begin_anew();
}

void Person::lead(const Four& angles) {
  if (!streamed_) streamed_.emplace(angles_);
  streamed_->target = in_use(angles);
  further_.clear();
}

void Person::bring_along(std::vector<Place> places) {
  streamed_.reset();
  further_.assign(places.begin(), places.end());
  bring_next();
}

double Person::turn(unsigned pot, double each_way) {
  const bool leader = pot < rest_.leader.size();
  const Four& rest = leader ? rest_.leader : rest_.follower;
  std::vector<Place> places;
  const auto go = [&](const Four& to, double seconds) {
    places.push_back({leader ? std::optional(to) : std::nullopt, leader ? std::nullopt : std::optional(to),
                      slices(seconds, slice_)});
  };
  for (const double end : kEnds) {
    Four to = rest;
    to[pot % to.size()] = end;
    go(to, each_way);
    go(to, kPause);
  }
  go(rest, each_way);
  bring_along(std::move(places));
  return 3.0 * each_way + 2.0 * kPause;
}

double Person::pose(const Four& angles) {
  bring_along({{angles, angles, slices(kBring, slice_)}});
  return kBring;
}

double Person::hang() {
  bring_along({{std::nullopt, kHanging, slices(kBring, slice_)}});
  return kBring;
}

void Person::step(bool enabled, const Four& follower) {
  paused_ = enabled ? 0 : paused_ + 1;
  if (worked_ && paused_ && paused_ < patience_) return;
  worked_ = worked_ || enabled;
  if (streamed_) {
    streamed_->step(slice_);
    rest_ = {streamed_->angles(), streamed_->angles()};
  }
  if (enabled) {
    follow_motion();
  } else if (off_ < let_go_) {
    ++off_;
    on_ = 0;
    left_at_ = {angles_, follower};
  } else if (off_ < let_go_ + way_) {
    ++off_;
    const double share = static_cast<double>(off_ - let_go_) / static_cast<double>(way_);
    angles_ = between(left_at_.leader, rest_.leader, share);
    hold = between(left_at_.follower, rest_.follower, share);
  } else {
    angles_ = rest_.leader;
    hold = rest_.follower;
    on_ = 0;
    if (!further_.empty()) bring_next();
  }
}

void Person::bring_next() {
  const Place place = further_.front();
  further_.pop_front();
  if (place.leader) rest_.leader = in_use(*place.leader);
  if (place.follower) rest_.follower = in_use(*place.follower);
  set_out(std::max<std::uint64_t>(1, place.slices));
}

// Begins to bring both arms to their places, from where they are held.
void Person::set_out(std::uint64_t way) {
  left_at_ = {angles_, *hold};
  off_ = let_go_;
  way_ = way;
}

void Person::learn(Motion motion) {
  motion_ = std::move(motion);
  rows_ = motion_.rows;
  piece_.clear();
  piece_first_ = 0;
  home_ = row(0);
}

// Goes from where the leader arm is to the first pose, and plays from there.
void Person::begin_anew() {
  taken_at_ = angles_;
  on_ = 1;
}

void Person::begin_work() {
  off_ = 0;
  hold.reset();
  rest_ = {home_, home_};
  further_.clear();
  way_ = bring_back_;
  taken_at_ = angles_;
  if (streamed_) streamed_->take(angles_);
}

void Person::follow_motion() {
  if (on_ == 0) begin_work();
  ++on_;
  if (streamed_) {
    angles_ = streamed_->angles();
    return;
  }
  if (on_ < start_) {  // the motors may have gone on while the arms were being brought back
    angles_ = between(taken_at_, home_, static_cast<double>(on_) / static_cast<double>(start_));
    return;
  }
  const std::uint64_t at = on_ - start_;
  if (at == rows_) ++plays_;
  if (at <= rows_) angles_ = row(std::min(at, rows_ - 1));
}

Four Person::row(std::uint64_t index) {
  if (index < piece_first_ || index - piece_first_ >= piece_.size()) {
    piece_.resize(static_cast<std::size_t>(slices(1.0, slice_)));
    piece_first_ = index;
    motion_.read(index, piece_);
    for (Four& pose : piece_) pose = in_use(pose);
  }
  return piece_[static_cast<std::size_t>(index - piece_first_)];
}

Four Person::in_use(const Four& angles) const {
  Four pose{};
  for (std::size_t joint = 0; joint < pose.size(); ++joint) pose[joint] = angles[joint] * in_use_[joint];
  return pose;
}

}  // namespace greywhale::bench
