// The person at the bench: leads the leader arm by hand, and lifts the follower back when the motors are off.
//
// The person waits for the drivers' enable pin (a board's LED shows the same), lets the soft start pass, plays a motion
// once and holds the last pose, or leads live, wherever they are told. A while after the motors went off, the person
// brings both arms back to the first pose and holds them there, so that the next enable is accepted. Until then nobody
// touches the follower, so that a fall or coasting after a stop shows.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "seams.h"

namespace greywhale::bench {

// A leader's motion, a row (rad) for each slice. It is read in pieces, so that an hour needs no more memory than a
// second: `read` fills the piece with rows from `first` on; past the end the last pose stays.
struct Motion {
  std::uint64_t rows;
  std::function<void(std::uint64_t first, std::vector<Four>& piece)> read;
};

Motion still_motion(const Four& pose);

// A leader that is sent angles again and again: it goes there smoothly, and no faster than hands are.
class StreamedLeader {
 public:
  explicit StreamedLeader(const Four& angles) : target(angles), angles_(angles) {}

  // Begins anew from where the arm is.
  void take(const Four& angles) {
    angles_ = angles;
    speeds_ = {};
  }
  void step(double slice);

  Four target;
  const Four& angles() const { return angles_; }

 private:
  Four angles_, speeds_{};
};

class Person {
 public:
  // Where hands bring leader and follower (none: where it is), and how many slices they take.
  struct Place {
    std::optional<Four> leader, follower;
    std::uint64_t slices;
  };
  struct Both {
    Four leader, follower;
  };

  static constexpr double kStart = 1.5;       // s from enable to the first movement: the soft start takes 1 s
  static constexpr double kLetGo = 0.5;       // s from motors off to the hand on the follower
  static constexpr double kBringBack = 1.0;   // s from where the arms are to the first pose
  static constexpr unsigned kAllJoints = 15;  // bits
  // What a calibration asks of hands. No track ends within a sweep, whose positive end comes first (rad).
  static constexpr double kDegree = 3.14159265358979323846 / 180.0;
  static constexpr double kEnds[] = {75.0 * kDegree, -70.0 * kDegree};
  static constexpr double kEachWay = 1.0, kPause = 0.1;               // s, of a sweep's ways, and at its ends
  static constexpr double kBring = 1.0;                               // s to a pose
  static constexpr Four kHanging = {0.0, -80.0 * kDegree, 0.0, 0.0};  // of the follower

  // Joints that are not in use (bits) stay at 0, whatever the motion and the hands want.
  Person(Motion motion, double slice, double start = kStart, unsigned in_use = kAllJoints);

  // Plays another motion: at work, from its first pose on, to which the leader goes as after an enable; else from the
  // next enable on, and held arms are brought to its first pose within a second.
  void take_up(Motion motion);

  // Leads to angles (rad), now, whether the motors are on or off, and to others when this is called again. While they
  // are off, the other hand brings the follower along. Ends with `take_up` and with `bring_along`.
  void lead(const Four& angles);

  // Brings held arms to one place after another; only while the follower is held.
  void bring_along(std::vector<Place> places);

  // What a calibration asks for, while the follower is held; how many seconds it takes. Turns the joint of a
  // potentiometer (0..3 leader, 4..7 follower) to its positive end, to its negative end, and back.
  double turn(unsigned pot, double each_way = kEachWay);
  // Holds both arms in one pose.
  double pose(const Four& angles);
  // Lets the follower hang, as for pulses of its motors.
  double hang();
  bool has_free_hands() const { return hold && !on_the_way(); }

  // Motors that are off for less than so many slices do not end the work: the person waits where they are.
  void set_patience(std::uint64_t slices) { patience_ = slices; }

  // Advances one slice; `follower` is where the follower is now.
  void step(bool enabled, const Four& follower);

  const Four& angles() const { return angles_; }  // of the leader arm
  // The pose in which the other hand holds the follower; none while it is free.
  std::optional<Four> hold;
  const Four& home() const { return home_; }
  const Both& rest() const { return rest_; }  // where the hands bring both arms
  std::uint64_t plays() const { return plays_; }
  bool finished() const { return on_ >= start_ + rows_; }  // played to its end since the motors went on
  bool on_the_way() const { return !further_.empty() || off_ < let_go_ + way_; }

 private:
  void learn(Motion motion);
  Four row(std::uint64_t index);
  Four in_use(const Four& angles) const;
  void follow_motion();
  void begin_anew();
  void begin_work();
  void bring_next();
  void set_out(std::uint64_t way);

  double slice_;
  Four in_use_;
  std::uint64_t start_, let_go_, bring_back_;  // slices
  Motion motion_;
  std::uint64_t rows_ = 0;
  std::vector<Four> piece_;
  std::uint64_t piece_first_ = 0;
  Four home_{}, angles_{};
  Both left_at_{}, rest_{};    // both arms when the hands took them
  std::deque<Place> further_;  // where the hands go then
  std::uint64_t on_ = 0;       // slices since the motors went on
  std::uint64_t off_, way_;    // slices since they went off, or since the hands set out; until they are there
  Four taken_at_{};            // the leader arm when the motors went on
  std::uint64_t plays_ = 0, patience_ = 0, paused_ = 0;
  bool worked_ = false;
  std::optional<StreamedLeader> streamed_;  // in the place of the motion
};

}  // namespace greywhale::bench
