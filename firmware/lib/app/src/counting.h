// Counters that a host may read: they stop at their largest number.
#pragma once
#include <stdint.h>

namespace app {

inline uint16_t add_saturated(uint16_t count, uint8_t more) {
  return count > UINT16_MAX - more ? uint16_t{UINT16_MAX} : static_cast<uint16_t>(count + more);
}

}  // namespace app
