// The person at the bench inside a page: leads the leader arm by hand, and brings the follower along while the motors
// are off. The same as greywhale_sim.leader_player with a StreamedLeader; tests/oracles proves it.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

namespace greywhale::web {

using Four = std::array<double, 4>;

class BenchPerson {
 public:
  explicit BenchPerson(const Four& angles) : angles_(angles) {}

  void lead(const Four& target) { target_ = target; }  // rad
  const Four& angles() const { return angles_; }       // of the leader arm
  // The pose in which the other hand holds the follower; none while the motors have it.
  const std::optional<Four>& hold() const { return hold_; }

  // Advances 250 us; `follower` is where the follower is now.
  void step(bool enabled, const Four& follower) {
    move();
    if (enabled) {
      if (!on_) let_go();
      angles_ = wanted_;
    } else if (off_ < kLetGo) {
      ++off_;
      left_leader_ = angles_;
      left_follower_ = follower;
    } else if (off_ < kLetGo + kBringBack) {
      ++off_;
      const double share = static_cast<double>(off_ - kLetGo) / kBringBack;
      angles_ = between(left_leader_, share);
      hold_ = between(left_follower_, share);
    } else {
      angles_ = wanted_;
      hold_ = wanted_;
    }
    on_ = enabled;
  }

 private:
  // A critically damped pull (1/s), and no faster than hands are (rad/s).
  static constexpr double kPull = 25.0, kFastest = 5.0, kSlice = 250e-6;
  static constexpr unsigned kLetGo = 2000, kBringBack = 4000;  // slices

  void move() {
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const double pull = kPull * kPull * (target_[i] - wanted_[i]) - 2.0 * kPull * speeds_[i];
      speeds_[i] = std::clamp(speeds_[i] + kSlice * pull, -kFastest, kFastest);
      wanted_[i] += kSlice * speeds_[i];
    }
  }

  void let_go() {
    off_ = 0;
    hold_.reset();
    wanted_ = angles_;
    speeds_ = {};
  }

  Four between(const Four& start, double share) const {
    Four pose{};
    for (std::size_t i = 0; i < pose.size(); ++i) pose[i] = start[i] + share * (wanted_[i] - start[i]);
    return pose;
  }

  Four angles_, target_ = angles_, wanted_ = angles_, speeds_{}, left_leader_ = angles_, left_follower_ = angles_;
  std::optional<Four> hold_ = angles_;
  unsigned off_ = kLetGo + kBringBack;  // slices since the motors went off
  bool on_ = false;
};

}  // namespace greywhale::web
