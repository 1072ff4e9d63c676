// The angles of the potentiometers: owns the signals and sets them up from the parameter table.
#pragma once
#include <hal.h>
#include <params/table.h>
#include <stdint.h>

#include "memory_check.h"
#include "signals.h"

namespace app {

class Sampling {
 public:
  constexpr Sampling() : shift_(0), primed_(false) {}

  void configure(const params::Table& table);
  // The same for one joint. True when that changed anything: if the table is as before, a bit had flipped. While the
  // host leads, the leader's line stays as it is: it is the host's reference.
  bool configure_joint(const params::Table& table, uint8_t joint, bool host_leads);
  // Before each tick.
  void prepare_low_passes();
  // Takes the sums of all pots, as hal::pot_sums() gives them, and writes the rails into `seen`.
  void tick(const uint16_t* sums, supervisor::Observation& seen);
  // What the probe says of the pot that was probed last: whether its input has no wire, or one that touches another's.
  enum class Wire : uint8_t { good, off, touches };
  Wire judge(hal::Probe probe) const;
  // From here to the next tick no reading counts: the distances are farther than two angles can be apart.
  void forget();

  // A bit for each pot that has a scale. The others are not there, and their inputs may read anything.
  uint8_t pots_in_use() const { return pots_in_use_; }
  // Where the rails begin.
  Part rails() const {
    return {reinterpret_cast<const uint8_t*>(&signals_.lowest), sizeof signals_.lowest + sizeof signals_.span};
  }

  // The leader's angle, or the host's reference while the host leads.
  int16_t leader(uint8_t joint) const { return signal_chain::angle(signals_.joint[joint].leader); }  // q12 rad
  int16_t follower(uint8_t joint) const { return signals_.joint[joint].follower_angle; }
  // Reference minus follower; the reference is the leader within the joint's limits.
  int16_t error(uint8_t joint) const { return signals_.joint[joint].error; }
  // Of the last tick, also when the host's reference has moved on since.
  int16_t reference(uint8_t joint) const { return static_cast<int16_t>(follower(joint) + error(joint)); }
  // While the motors are on, a reading at a rail leaves its angle as it is.
  void hold(bool on) { signals_.rails = static_cast<uint8_t>((signals_.rails & tell_rails) | (on ? hold_rails : 0)); }
  int16_t within_limits(uint8_t joint, int16_t angle) const;
  // Between reference and follower, as they are now; the last tick may have seen another reference.
  uint16_t distance(uint8_t joint) const;

  // Puts a reference in the place of a leader pot until configure() is called. The reference is a line of slope 0, so a
  // tick does what it always does. move_lead() moves the reference, in 2^-15 q12 rad.
  void lead(uint8_t joint, int16_t angle);
  void move_lead(uint8_t joint, int32_t by);
  // The same by 2^-shift of the reference's distance from an angle, which counts within +-8 rad.
  void approach(uint8_t joint, int32_t angle_q25, uint8_t shift);
  // What the leader's potentiometer says while a reference is in its place.
  int32_t leader_q27(uint8_t joint, const params::Table& table) const;

 private:
  static constexpr int16_t not_seen = INT16_MIN;  // the least error is one more

  Signals signals_ = {};
  uint8_t pots_in_use_ = 0;
  uint8_t shift_ : 7;  // of the low-passes
  bool primed_ : 1;    // a tick has come, so the low-passes hold something
};

}  // namespace app
