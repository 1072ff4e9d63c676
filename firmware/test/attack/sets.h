// Parameter sets: whether two are the same, what a value may be, and random ones that the controllers can run.
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

// The description of a parameter of the table.
inline const params::Field& field_of(std::uint16_t index) {
  const params::Group* group = params::groups;
  for (; index >= group->elements * group->fields; ++group) {
    index = static_cast<std::uint16_t>(index - group->elements * group->fields);
  }
  return params::fields[group->first_field + index % group->fields];
}

params::Table random_set(Random& random);

// A value for one parameter, anywhere in its range.
std::int32_t random_value(Random& random, std::uint16_t index);

}  // namespace attack
