// What the firmware's tick does around the fuzzy law, in the firmware's own integers: filter, angle, soft start, duty.
// firmware/lib/app (sampling.cpp, drive.cpp, controllers.cpp), firmware/lib/supervisor and the board's pins.h have the originals;
// the tests hold this file against the compiled firmware on the simulated chip, duty by duty.
#pragma once

#include <cstdint>

namespace greywhale::loop {

// The 10-bit count x 64 after the low-pass; a sum is of four conversions.
inline std::uint16_t low_pass(std::uint16_t old, std::uint16_t sum, int shift) {
  const auto sample = static_cast<std::uint16_t>(sum << 4);
  if (shift == 0) return sample;
  const int halvings = shift - 1;
  if (sample >= old) return static_cast<std::uint16_t>(old + ((((sample - old) >> halvings) + 1) >> 1));
  return static_cast<std::uint16_t>(old - ((((old - sample) >> halvings) + 1) >> 1));
}

inline std::int16_t to_angle(std::uint16_t filtered, std::uint16_t zero, std::int16_t scale) {
  const std::int32_t count14 = (filtered + 2) >> 2;
  return static_cast<std::int16_t>(((count14 - zero) * scale + 4096) >> 13);
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

inline std::uint16_t per_supply(std::uint16_t supply_mv) {
  return static_cast<std::uint16_t>(((1u << 27) + supply_mv / 2u) / supply_mv);
}

// The compare value of one motor's PWM, negative where the direction pin is low.
inline std::int32_t compare_value(std::int32_t millivolts, std::uint16_t per_supply, std::int32_t sign, std::int32_t top) {
  const std::uint32_t size = static_cast<std::uint32_t>(millivolts < 0 ? -millivolts : millivolts);
  std::uint32_t duty = (size * per_supply) >> 12;
  if (duty > 32767) duty = 32767;
  const auto compare = static_cast<std::int32_t>((duty * (2 * static_cast<std::uint32_t>(top)) + 0x8000u) >> 16);
  return (millivolts < 0) != (sign < 0) ? -compare : compare;
}

}  // namespace greywhale::loop
