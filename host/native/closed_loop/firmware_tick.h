// What the firmware's tick does around the fuzzy law, in the firmware's own integers: filter, angle, soft start, duty.
// firmware/lib/app (sampling.cpp, drive.cpp, controllers.cpp), firmware/lib/supervisor and the board's pins.h have the originals;
// the tests hold this file against the compiled firmware on the simulated chip, duty by duty.
#pragma once

#include <cstdint>

namespace greywhale::loop {

// The 10-bit count x 64 after the low-pass; a sum is of four conversions. The first sum is taken as it is: shift 0.
inline std::uint16_t low_pass(std::uint16_t old, std::uint16_t sum, int shift) {
  const std::uint32_t kept = old * (256u - (256u >> shift)) + 128u;
  return static_cast<std::uint16_t>((kept >> 8) + sum * (16u >> shift));
}

inline std::int16_t to_angle(std::uint16_t filtered, std::uint16_t zero, std::int16_t scale) {
  return static_cast<std::int16_t>((filtered * scale + (0x4000 - 4 * zero * scale)) >> 15);
}

// The voltage limit after enable: it grows by the same step each tick.
class SoftStart {
 public:
  explicit SoftStart(std::uint16_t milliseconds) : left_(milliseconds), step_(milliseconds ? kFull / milliseconds : 0) {}

  std::uint16_t next_limit_mv(std::uint16_t supply_mv) {
    if (left_ != 0) {
      ramp_ = --left_ != 0 ? ramp_ + step_ : kFull;
    } else {
      ramp_ = kFull;
    }
    return static_cast<std::uint16_t>((std::uint32_t{supply_mv} * (ramp_ >> 16)) >> 15);
  }

 private:
  static constexpr std::uint32_t kFull = 1u << 31;
  std::uint32_t left_, step_, ramp_ = 0;
};

// Compare values per mV, 2^-18.
inline std::int32_t duty_scale(std::int32_t top, std::int32_t supply_mv) {
  return static_cast<std::int32_t>(((static_cast<std::uint32_t>(top) << 18) + static_cast<std::uint32_t>(supply_mv) / 2) /
                                   static_cast<std::uint32_t>(supply_mv));
}

// The compare value of one motor's PWM, negative where the direction pin is low. |millivolts| is at most the supply.
inline std::int32_t compare_value(std::int32_t millivolts, std::int32_t scale, std::int32_t sign) {
  const std::int32_t size = millivolts < 0 ? -millivolts : millivolts;
  const std::int32_t compare = (size * scale + (1 << 17)) >> 18;
  return (millivolts < 0) != (sign < 0) ? -compare : compare;
}

}  // namespace greywhale::loop
