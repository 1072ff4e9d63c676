// Parameter sets: whether two are the same, and random ones that the controllers can run.
#pragma once
#include <params/params.h>

#include <cstring>
#include <random>

namespace attack {

using Random = std::mt19937_64;

inline std::int64_t between(Random& random, std::int64_t least, std::int64_t most) {
  return least + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most - least + 1));
}

inline bool same(const params::Table& a, const params::Table& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

params::Table random_set(Random& random);

// A value for one parameter, anywhere in its range.
std::int32_t random_value(Random& random, std::uint16_t index);

}  // namespace attack
