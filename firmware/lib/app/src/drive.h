// From motor voltages to duties and directions.
#pragma once
#include <hal.h>
#include <params/table.h>
#include <signal_chain/duty.h>
#include <stdint.h>

#include "memory_check.h"

namespace app {

class Drive {
 public:
  void configure(const params::Table& table);
  // size_mv <= the supply; bit 7 of sign: the voltage is negative. `table` is the configured one.
  template <uint8_t joint>
  void set(uint16_t size_mv, uint8_t sign, const params::Table& table) const;
  void release() const;  // all duties 0
  Part settings() const { return {reinterpret_cast<const uint8_t*>(scale_), sizeof(scale_)}; }

 private:
  uint16_t scale_[hal::joint_count] = {};  // see signal_chain::duty_scale()
};

template <uint8_t joint>
inline __attribute__((always_inline)) void Drive::set(uint16_t size_mv, uint8_t sign,
                                                      const params::Table& table) const {
  const uint16_t duty = signal_chain::duty(size_mv, scale_[joint]);
  const auto direction = static_cast<int8_t>(sign ^ static_cast<uint8_t>(table.joint[joint].motor_sign));
  hal::set_duty<joint>(direction >= 0, duty);
}

}  // namespace app
