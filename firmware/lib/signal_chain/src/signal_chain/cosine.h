// The cosine of an angle, for what gravity does to a joint.
#pragma once
#include <stdint.h>

namespace signal_chain {

// q7, of an angle in q12 rad within +-8 rad; off by at most 0.02.
__attribute__((noinline)) inline int8_t cosine(int16_t angle) {
  constexpr uint8_t half = 128;  // turn
  const auto phase = static_cast<uint8_t>(((int32_t{angle} * 652 + 32768) >> 16) + half / 2);
  const bool behind = phase > half;
  const auto from_zero = static_cast<uint8_t>(behind ? phase - half : phase);
  // The sine of the phase: the parabola through it, and 0.225 of what the parabola's square is away from it.
  const auto parabola = static_cast<uint8_t>(from_zero * (half - from_zero) / 32u);
  const auto away = static_cast<uint8_t>(parabola * (half - parabola) / 128u);
  const auto value = static_cast<int8_t>(parabola - (away * 29u) / 128u - (parabola == half ? 1 : 0));
  return static_cast<int8_t>(behind ? -value : value);
}

}  // namespace signal_chain
