// From motor voltages to duties and directions.
#pragma once
#include <hal.h>
#include <params/table.h>
#include <signal_chain/duty.h>
#include <stdint.h>

#include "memory_watch.h"

namespace app {

class Drive {
 public:
  void configure(const params::Table& table);
  // size_mv <= the supply; bit 7 of sign: the voltage is negative
  template <uint8_t joint>
  void set(uint16_t size_mv, uint8_t sign) const;
  void release() const;  // all duties 0
  Part settings() const { return {reinterpret_cast<const uint8_t*>(motors_), sizeof(motors_)}; }

 private:
  struct Motor {
    uint16_t scale;  // see signal_chain::duty_scale()
    int8_t sign;     // below 0: the motor turns the other way
  };
  Motor motors_[hal::joint_count] = {};
};

template <uint8_t joint>
inline __attribute__((always_inline)) void Drive::set(uint16_t size_mv, uint8_t sign) const {
  const uint16_t duty = signal_chain::duty(size_mv, motors_[joint].scale);
  const auto direction = static_cast<int8_t>(sign ^ static_cast<uint8_t>(motors_[joint].sign));
  hal::set_duty<joint>(direction >= 0, duty);
}

}  // namespace app
