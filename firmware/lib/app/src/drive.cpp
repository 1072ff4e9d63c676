// See drive.h.
#include "drive.h"

namespace app {
namespace {

constexpr uint16_t full_duty = 32767;

}  // namespace

// supply_mv is 3000..30000, so the quotient has 13..16 bits and costs at most 0.01 % of full duty.
void Drive::configure(const params::Table& table) {
  const uint32_t half = table.supply_mv / 2u;
  per_supply_ = static_cast<uint16_t>(((1UL << 27) + half) / table.supply_mv);
  for (uint8_t i = 0; i < hal::joint_count; ++i) sign_[i] = table.joint[i].motor_sign;
}

void Drive::set(uint8_t joint, int16_t millivolts) const {
  const bool negative = millivolts < 0;
  const uint16_t size = static_cast<uint16_t>(negative ? -millivolts : millivolts);
  // duty = size * 2^15 / supply = (size * per_supply) >> 12, written as one shift by 16
  const uint32_t product = static_cast<uint32_t>(size) * per_supply_;
  uint16_t duty = static_cast<uint16_t>((product << 4) >> 16);
  if (duty > full_duty) duty = full_duty;
  const bool reverse = negative != (sign_[joint] < 0);
  hal::set_duty(joint, static_cast<int16_t>(reverse ? -static_cast<int16_t>(duty) : static_cast<int16_t>(duty)));
}

void Drive::release() const {
  for (uint8_t i = 0; i < hal::joint_count; ++i) hal::set_duty(i, 0);
}

}  // namespace app
