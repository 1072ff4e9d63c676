// See sampling.h.
#include "sampling.h"

namespace app {
namespace {

constexpr uint16_t full_count = 1023;

// Of four counts each. A joint that moves reads differently a little later, and a pot has its noise.
constexpr uint8_t less = 8, more = 2;

// Whether that changed anything.
__attribute__((noinline)) bool calibrate(signal_chain::Pot& pot, const params::PotParameters& parameters) {
  const signal_chain::Pot was = pot;
  pot.scale = parameters.scale;
  pot.offset = signal_chain::offset(parameters.zero, parameters.scale);
  return pot.scale != was.scale || pot.offset != was.offset;
}

}  // namespace

void Sampling::configure(const params::Table& table) {
  shift_ = table.filter_shift & 0x7f;
  const uint8_t rail = table.rail_counts;
  const uint16_t lowest = rail ? static_cast<uint16_t>(rail * hal::conversions_per_pot + 1) : 0;
  const uint16_t highest = static_cast<uint16_t>((full_count - rail) * hal::conversions_per_pot - 1);
  signals_.lowest = lowest;
  signals_.span = rail ? static_cast<uint16_t>(highest - lowest) : static_cast<uint16_t>(hal::rail_mark - 1);
  signals_.rails = rail ? tell_rails : 0;  // the motors are off, so nothing is held
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    configure_joint(table, i, false);
    JointSignals& joint = signals_.joint[i];
    joint.follower_angle = signal_chain::angle(joint.follower);
  }
  prepare_low_passes();
}

bool Sampling::configure_joint(const params::Table& table, uint8_t joint, bool host_leads) {
  JointSignals& signals = signals_.joint[joint];
  const params::PotParameters &leader = table.leader[joint], &follower = table.follower[joint];
  // A joint that is not in use has no error, so no voltage.
  int16_t least = 0, most = 0;
  uint8_t in_use = leader.scale != 0;
  if (follower.scale != 0) {
    in_use |= 1u << 4;
    least = table.joint[joint].limit_min;
    most = table.joint[joint].limit_max;
  }
  const uint8_t others = static_cast<uint8_t>(~(0x11u << joint));
  const uint8_t pots = static_cast<uint8_t>((pots_in_use_ & others) | (in_use << joint));
  bool changed = signals.limit_min != least || signals.limit_max != most || pots_in_use_ != pots;
  signals.limit_min = least;
  signals.limit_max = most;
  pots_in_use_ = pots;
  changed |= calibrate(signals.follower, follower);
  if (!host_leads) changed |= calibrate(signals.leader, leader);
  return changed;
}

void Sampling::tick(const uint16_t* sums, supervisor::Observation& seen) {
  follow_pots(sums, &signals_, &seen);
  primed_ = true;
}

Sampling::Wire Sampling::judge(hal::Probe probe) const {
  if (probe.pot >= hal::pot_count || !(signals_.rails & tell_rails)) return Wire::good;
  if (probe.count > probe.usual + more) return Wire::touches;
  // A wire that is off brings some charge along.
  return probe.count + less < probe.usual - probe.usual / 8 ? Wire::off : Wire::good;
}

void Sampling::prepare_low_passes() {
  signals_.low_pass = signal_chain::low_pass(primed_ ? shift_ : 0);  // the first sample is taken whole
  app::prepare_low_passes(signals_);
}

int16_t Sampling::within_limits(uint8_t joint, int16_t angle) const {
  const JointSignals& signals = signals_.joint[joint];
  return signal_chain::clamp(angle, signals.limit_min, signals.limit_max);
}

void Sampling::forget() {
  for (JointSignals& joint : signals_.joint) joint.error = not_seen;
}

uint16_t Sampling::distance(uint8_t joint) const {
  if (error(joint) == not_seen) return UINT16_MAX;
  return signal_chain::distance(within_limits(joint, leader(joint)), follower(joint));
}

void Sampling::lead(uint8_t joint, int16_t angle) {
  signal_chain::Pot& pot = signals_.joint[joint].leader;
  signals_.joint[joint].error = static_cast<int16_t>(angle - follower(joint));
  pot.scale = 0;
  pot.offset = static_cast<int32_t>(angle) * 0x8000 + 0x4000;
}

void Sampling::move_lead(uint8_t joint, int32_t by) { signals_.joint[joint].leader.offset += by; }

void Sampling::approach(uint8_t joint, int32_t angle_q25, uint8_t shift) {
  constexpr int32_t most = 0xfff0000;
  const int32_t within = angle_q25 < -most ? -most : angle_q25 > most ? most : angle_q25;
  signal_chain::Pot& pot = signals_.joint[joint].leader;
  pot.scale = 0;
  pot.offset += (within * 4 + 0x4000 - pot.offset) >> shift;
}

int32_t Sampling::leader_q27(uint8_t joint, const params::Table& table) const {
  const params::PotParameters& pot = table.leader[joint];
  return (int32_t{signals_.joint[joint].leader.filtered} - int32_t{pot.zero} * 4) * pot.scale;
}

}  // namespace app
