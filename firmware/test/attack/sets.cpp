// See sets.h.
#include "sets.h"

namespace attack {
namespace {

constexpr std::int16_t narrowest = 164, widest = 16384;  // q14

std::int16_t right(Random& random) { return static_cast<std::int16_t>(between(random, narrowest, widest)); }
std::int16_t left(Random& random) { return static_cast<std::int16_t>(-right(random)); }

// Flanks on their own side of zero; an integral that the period's format holds.
void mend(Random& random, params::JointParameters& joint, std::uint8_t period_ms) {
  joint.ne_c = left(random);
  joint.ze_a = left(random);
  joint.nce_c = left(random);
  joint.zce_a = left(random);
  joint.ze_c = right(random);
  joint.pe_b = right(random);
  joint.zce_c = right(random);
  joint.pce_b = right(random);
  joint.ki = static_cast<std::uint32_t>(between(random, 0, ((1 << 28) - 1) / period_ms)) % 65536000;
  joint.limit_min = static_cast<std::int16_t>(between(random, -25723, 0));
  joint.limit_max = static_cast<std::int16_t>(between(random, 1, 25723));
}

}  // namespace

std::int32_t random_value(Random& random, std::uint16_t index) {
  const params::Field& field = field_of(index);
  const std::int64_t value = between(random, field.minimum, field.maximum);
  return static_cast<std::int32_t>(value == 0 && field.nonzero ? 1 : value);
}

params::Table random_set(Random& random) {
  params::Table table;
  params::load_defaults(table);
  for (std::uint16_t i = 0; i < params::count; ++i) params::set(table, i, random_value(random, i));
  for (params::JointParameters& joint : table.joint) mend(random, joint, table.period_ms);
  return table;
}

}  // namespace attack
