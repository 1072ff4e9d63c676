// See signals.h.
#include "signals.h"

#include <fuzzy_pdi.h>
#include <stddef.h>

#include "signals_layout.h"

namespace app {

#if defined(__AVR__)

// Every place that signals_avr.S reads or writes.
static_assert(offsetof(signal_chain::LowPass, gain) == SIGNALS_GAIN && offsetof(Signals, low_pass) == 0 &&
                  offsetof(Signals, lowest) == SIGNALS_LOWEST && offsetof(Signals, span) == SIGNALS_SPAN &&
                  offsetof(Signals, rails) == SIGNALS_RAILS && offsetof(Signals, joint) == SIGNALS_JOINT,
              "signals_layout.h");
static_assert(offsetof(JointSignals, leader) == JOINT_LEADER && offsetof(JointSignals, follower) == JOINT_FOLLOWER &&
                  offsetof(JointSignals, leader_old_share) == JOINT_LEADER_OLD_SHARE &&
                  offsetof(JointSignals, follower_old_share) == JOINT_FOLLOWER_OLD_SHARE &&
                  offsetof(JointSignals, follower_angle) == JOINT_FOLLOWER_ANGLE &&
                  offsetof(JointSignals, limit_min) == JOINT_LIMIT_MIN &&
                  offsetof(JointSignals, limit_max) == JOINT_LIMIT_MAX &&
                  offsetof(JointSignals, error) == JOINT_ERROR && sizeof(JointSignals) == JOINT_SIZE,
              "signals_layout.h");
static_assert(offsetof(signal_chain::Pot, filtered) == POT_FILTERED &&
                  offsetof(signal_chain::Pot, scale) == POT_SCALE && offsetof(signal_chain::Pot, offset) == POT_OFFSET,
              "signals_layout.h");
static_assert(offsetof(supervisor::Observation, rail_low) == SEEN_RAIL_LOW &&
                  offsetof(supervisor::Observation, rail_high) == SEEN_RAIL_LOW + 1,
              "signals_layout.h");
static_assert(hal::joint_count == 4 && supervisor::joint_count == 4 && hal::pot_count == 8,
              "signals_avr.S writes out each joint");

#endif

namespace {

// A sum between the rails has a mark when only some of its conversions were at one. It was the lower one if the sum
// fell.
bool at_lower_rail(uint16_t sum, const Signals& signals, uint16_t filtered) {
  if (sum < signals.lowest) return true;
  return sum - signals.lowest <= signals.span && static_cast<uint16_t>(sum << 4) < filtered;
}

// Takes the marks off. True when the sum must not be used.
bool note_rail(uint8_t pot, uint16_t& sum, const Signals& signals, uint16_t filtered, supervisor::Observation& seen) {
  if (static_cast<uint16_t>(sum - signals.lowest) <= signals.span) return false;
  sum = sum & (hal::rail_mark - 1);
  if (!(signals.rails & tell_rails)) return false;
  uint8_t& rail = at_lower_rail(sum, signals, filtered) ? seen.rail_low : seen.rail_high;
  rail = static_cast<uint8_t>(rail | (1u << pot));
  return (signals.rails & hold_rails) != 0;
}

int16_t follow(signal_chain::Pot& pot, uint16_t old_share, uint8_t number, uint16_t sum, const Signals& signals,
               supervisor::Observation& seen) {
  const bool hold = note_rail(number, sum, signals, pot.filtered, seen);
  if (!hold) pot.filtered = signal_chain::add_sum(old_share, sum, signals.low_pass);
  return signal_chain::angle(pot);
}

}  // namespace

void follow_pots_portable(const uint16_t* sums, Signals* signals, supervisor::Observation* seen) {
  seen->rail_low = seen->rail_high = 0;
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    const uint8_t other = static_cast<uint8_t>(i + hal::joint_count);
    JointSignals& joint = signals->joint[i];
    const int16_t wanted = signal_chain::clamp(
        follow(joint.leader, joint.leader_old_share, i, sums[i], *signals, *seen), joint.limit_min, joint.limit_max);
    const int16_t is = follow(joint.follower, joint.follower_old_share, other, sums[other], *signals, *seen);
    joint.follower_angle = is;
    joint.error = fuzzy_pdi::difference(wanted, is);
  }
}

void prepare_low_passes(Signals& signals) {
  for (JointSignals& joint : signals.joint) {
    joint.leader_old_share = signal_chain::old_share(joint.leader.filtered, signals.low_pass);
    joint.follower_old_share = signal_chain::old_share(joint.follower.filtered, signals.low_pass);
  }
}

}  // namespace app
