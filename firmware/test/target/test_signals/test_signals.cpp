// The pass over the pots in assembly gives the same bits as its portable form: random readings at rails and away from
// them, every filter, extreme calibrations and limits.
#include <hal.h>
#include <signals.h>

#include "../report.h"

namespace {

using app::Signals;

void calibrate(signal_chain::Pot& pot) {
  constexpr int16_t scales[] = {10734, -10734, 1, -1, 16384, -16384};
  const uint16_t zero = next_random() % 16369;
  pot.scale = next_random() & 1 ? scales[next_random() % 6] : static_cast<int16_t>(next_random()) / 2;
  pot.offset = signal_chain::offset(zero, pot.scale);
  pot.filtered = next_random() % 65473;
}

// As a reference that the host leads: a line of slope 0 anywhere.
void lead(signal_chain::Pot& pot) {
  pot.scale = 0;
  pot.offset = static_cast<int32_t>(static_cast<int16_t>(next_random()) / 4) * 0x10000 + next_random();
}

void configure(Signals& signals, uint8_t shift) {
  memset(&signals, 0, sizeof signals);
  signals.low_pass = signal_chain::low_pass(shift);
  const uint16_t rail = next_random() % 101;
  signals.lowest = rail ? rail * 4 + 1 : 0;
  signals.span = rail ? (1023 - rail) * 4 - 1 - signals.lowest : 0x0fff;
  signals.rails = static_cast<uint8_t>(rail ? app::tell_rails | (next_random() & app::hold_rails) : 0);
  for (app::JointSignals& joint : signals.joint) {
    calibrate(joint.leader);
    calibrate(joint.follower);
    if ((next_random() & 3) == 0) lead(joint.leader);
    joint.follower_angle = signal_chain::angle(joint.follower);
    joint.limit_min = static_cast<int16_t>(next_random()) / 2;
    joint.limit_max = static_cast<int16_t>(joint.limit_min + 1 + (next_random() & 0x3fff));
  }
}

uint16_t reading() {
  switch (next_random() & 7) {
    case 0: return next_random() % 410;         // about the lower rail
    case 1: return 4092 - next_random() % 410;  // and the upper one
    case 2: return next_random() & 1 ? 4092 : 0;
    default: return next_random() % 4093;
  }
}

}  // namespace

int main() {
  uint16_t signals_differ = 0, seen_differs = 0;
  uint16_t low = 0, high = 0, clamped = 0, saturated = 0;  // what the readings came across
  for (uint16_t set = 0; set < 250; ++set) {
    Signals fast;
    configure(fast, static_cast<uint8_t>(set % 5));
    Signals portable = fast;
    for (uint8_t tick = 0; tick < 8; ++tick) {
      uint16_t sums[hal::pot_count];
      for (uint16_t& sum : sums) sum = reading() | (next_random() & 7 ? 0 : hal::rail_mark * (1 + (next_random() & 3)));
      supervisor::Observation by_fast = {}, by_portable = {};
      app::prepare_low_passes(fast);
      app::prepare_low_passes(portable);
      app::follow_pots(sums, &fast, &by_fast);
      app::follow_pots_portable(sums, &portable, &by_portable);
      signals_differ += memcmp(&fast, &portable, sizeof fast) != 0;
      seen_differs += memcmp(&by_fast, &by_portable, sizeof by_fast) != 0;
      low += by_portable.rail_low != 0;
      high += by_portable.rail_high != 0;
      for (const app::JointSignals& joint : portable.joint) {
        const int16_t leader = signal_chain::angle(joint.leader);
        clamped += leader < joint.limit_min || leader > joint.limit_max;
        saturated += joint.error == 32767 || joint.error == -32767;
      }
    }
  }
  hal::begin();
  EQUAL("angles_errors_and_filters", signals_differ, 0);
  EQUAL("rails", seen_differs, 0);
  WITHIN("rails_were_met", low < high ? low : high, 100, 1990);
  WITHIN("limits_were_met", clamped, 100, 7900);
  WITHIN("errors_were_cut", saturated, 20, 7900);
  report::end();
}
