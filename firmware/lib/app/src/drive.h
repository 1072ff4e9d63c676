// From motor voltages to duties: division by the supply as a product, and the motors' signs.
#pragma once
#include <hal.h>
#include <params/table.h>
#include <stdint.h>

namespace app {

class Drive {
 public:
  void configure(const params::Table& table);
  void set(uint8_t joint, int16_t millivolts) const;   // |millivolts| <= the supply
  void release() const;                                // all duties 0

 private:
  uint16_t per_supply_ = 0;   // 2^27 / supply_mv
  int8_t sign_[hal::joint_count] = {1, 1, 1, 1};
};

}  // namespace app
