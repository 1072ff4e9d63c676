// Angles of the follower that the board reads like angles of the leader: error is the difference of two readings.
#pragma once

#include <array>

#include "experiment.h"

namespace greywhale::loop {

// angle = times x other + plus, rad.
struct Line {
  double times, plus;
};
using Lines = std::array<Line, kJoints>;

using Pots4 = std::array<arm::Potentiometer, kJoints>;

namespace detail {

// A joint's angle by its reading, with a straight potentiometer that shows the angle without play, lag and noise. A
// converter rounds down, by half a count on average.
inline Line angle_by_reading(const arm::Potentiometer& pot, double supply, std::uint16_t zero, std::int16_t scale) {
  constexpr double kQ12 = 4096.0, kScaleUnit = 8192.0, kOfACount = 16.0;  // firmware/lib/signal_chain
  const double full = kOfACount * supply * 1000.0 * 1024.0 / kConverterMillivolts;
  const double per_step = pot.direction * pot.track / full;
  return {per_step * kQ12 * kScaleUnit / scale, pot.centre + per_step * (zero + 0.5 * kOfACount - 0.5 * full)};
}

}  // namespace detail

// The follower's angle that reads as an angle of the leader does; the same angle where a potentiometer is not there.
inline Lines follower_lines(const Settings& settings, const Pots4& leader, double leader_supply, const Pots4& follower,
                            double follower_supply) {
  Lines lines;
  for (std::size_t i = 0; i < kJoints; ++i) {
    lines[i] = {1.0, 0.0};
    if (settings.leader.scale[i] == 0 || settings.follower.scale[i] == 0) continue;
    const Line led =
        detail::angle_by_reading(leader[i], leader_supply, settings.leader.zero[i], settings.leader.scale[i]);
    const Line own =
        detail::angle_by_reading(follower[i], follower_supply, settings.follower.zero[i], settings.follower.scale[i]);
    const double times = own.times / led.times;
    lines[i] = {times, own.plus - times * led.plus};
  }
  return lines;
}

}  // namespace greywhale::loop
