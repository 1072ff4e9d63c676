// What the firmware's tick does around the fuzzy law: firmware/lib/signal_chain, in the types of the closed loop.
// The tests hold the closed loop against the compiled firmware on the simulated chip, duty by duty.
#pragma once

#include <cstdint>

#include "signal_chain/duty.h"
#include "signal_chain/pot.h"
#include "signal_chain/soft_start.h"

namespace greywhale::loop {

// The 10-bit count x 64 after the low-pass; a sum is of four conversions. The first sum is taken as it is: shift 0.
inline std::uint16_t low_pass(std::uint16_t old, std::uint16_t sum, int shift) {
  return signal_chain::filter(old, sum, signal_chain::low_pass(static_cast<std::uint8_t>(shift)));
}

inline std::int16_t to_angle(std::uint16_t filtered, std::uint16_t zero, std::int16_t scale) {
  return signal_chain::angle({filtered, scale, signal_chain::offset(zero, scale)});
}

// The voltage limit after enable. Here a soft start may also take no time at all.
class SoftStart {
 public:
  explicit SoftStart(std::uint16_t milliseconds) : rises_(milliseconds != 0) {
    if (rises_) ramp_.start(milliseconds);
  }

  std::uint16_t next_limit_mv(std::uint16_t supply_mv) {
    if (rises_) rises_ = !ramp_.advance();
    return signal_chain::limit_mv(supply_mv, rises_ ? ramp_.share_q15() : std::uint16_t{32768});
  }

 private:
  signal_chain::SoftStart ramp_;
  bool rises_;
};

// Compare values per mV, 2^-18.
inline std::int32_t duty_scale(std::int32_t top, std::int32_t supply_mv) {
  return signal_chain::duty_scale(static_cast<std::uint16_t>(top), static_cast<std::uint16_t>(supply_mv));
}

// The compare value of one motor's PWM, negative where the direction pin is low. |millivolts| is at most the supply.
inline std::int32_t compare_value(std::int32_t millivolts, std::int32_t scale, std::int32_t sign) {
  const std::int32_t size = millivolts < 0 ? -millivolts : millivolts;
  const std::int32_t compare = signal_chain::duty(static_cast<std::uint16_t>(size), static_cast<std::uint16_t>(scale));
  return (millivolts < 0) != (sign < 0) ? -compare : compare;
}

}  // namespace greywhale::loop
