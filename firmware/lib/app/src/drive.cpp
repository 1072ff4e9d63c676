// See drive.h.
#include "drive.h"

namespace app {

void Drive::configure(const params::Table& table) {
  const uint16_t supply_mv = table.supply_mv;
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    const uint32_t full = static_cast<uint32_t>(hal::full_duty(i)) << 18;
    motors_[i].scale = static_cast<uint16_t>((full + supply_mv / 2u) / supply_mv);
    motors_[i].sign = table.joint[i].motor_sign;
  }
}

void Drive::release() const {
  for (uint8_t i = 0; i < hal::joint_count; ++i) hal::set_duty(i, true, 0);
}

}  // namespace app
