// See drive.h.
#include "drive.h"

namespace app {

void Drive::configure(const params::Table& table) {
  hal::choose_driver(static_cast<hal::Driver>(table.driver));
  for (uint8_t i = 0; i < hal::joint_count; ++i) {
    scale_[i] = signal_chain::duty_scale(hal::full_duty(i), table.supply_mv);
  }
}

void Drive::release() const {
  for (uint8_t i = 0; i < hal::joint_count; ++i) hal::set_duty(i, true, 0);
}

}  // namespace app
