// Reproducible noise: the n-th number of a stream is a function of (seed, stream, n), so nothing depends on who asks
// first. All of it is inlined, so a loop over n becomes one of vectors, with the same bits.
#pragma once

#include <cmath>
#include <cstdint>

#include "elementary.h"

namespace greywhale::arm {

// SplitMix64's finaliser: every bit of the result depends on every bit of the input.
GREYWHALE_INLINE std::uint64_t mixed(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

class Noise {
 public:
  GREYWHALE_INLINE Noise(std::uint64_t seed, std::uint64_t stream) : key_(mixed(mixed(seed) ^ mixed(~stream))) {}

  // In (0, 1).
  GREYWHALE_INLINE double uniform(std::uint64_t n) const {
    return (whole_number(mixed(key_ ^ mixed(n)) >> 12) + 0.5) * 0x1p-52;
  }

  // Mean 0, standard deviation 1 (Box and Muller).
  GREYWHALE_INLINE double gaussian(std::uint64_t n) const {
    constexpr double kTurn = 6.283185307179586;
    return std::sqrt(-2.0 * logarithm(uniform(2 * n))) * cosine(kTurn * uniform(2 * n + 1));
  }

 private:
  std::uint64_t key_;
};

}  // namespace greywhale::arm
