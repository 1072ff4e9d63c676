// A fuzzy PD+I controller for one motor, in integers: no heap, no float, no division in a control period.
//
//   constexpr fuzzy_pdi::Settings settings = greywhale::settings(0.5, 0.16, 0.3, 12.0);
//   greywhale::FuzzyPdi motor;
//   setup():           motor.begin(settings, 20)                          false where a setting is refused
//   every 20 ms:       motor.update(wanted, is, 12000)                    mV, within +-12 V
//
// Angles count 1/4096 rad, or 1/4096 of whatever unit kp, kd and ki are for.
#pragma once

#include "fuzzy_pdi/fuzzy_pdi.h"

#if defined(__AVR__) && !defined(__AVR_HAVE_MUL__)
#error "GreywhaleFuzzy needs an AVR that multiplies: an ATmega, not an ATtiny."
#endif

namespace greywhale {

// These take decimals, for constants: the compiler works them out, and no float reaches the chip.
constexpr int16_t corner(double share) { return static_cast<int16_t>(share * 16384 + (share < 0 ? -0.5 : 0.5)); }
constexpr uint32_t gain(double factor) { return static_cast<uint32_t>(factor * 65536 + 0.5); }
constexpr int16_t angle(double radians_) { return static_cast<int16_t>(radians_ * 4096 + (radians_ < 0 ? -0.5 : 0.5)); }

// kp 1/rad, kd 1/rad for a change over 20 ms, ki V/(rad s), ku V at full output. The sets are even; e and ce say where
// those of the error and of its change end, as a share of 1/kp and 1/kd. Smaller ones answer more sharply near zero.
constexpr fuzzy_pdi::Settings settings(double kp, double kd, double ki, double ku_volts, double e = 0.3,
                                       double ce = 0.1) {
  return {corner(-e), corner(-e), corner(e), corner(e), corner(-ce), corner(-ce),
          corner(ce), corner(ce), gain(kp),  gain(kd),  gain(ki),    static_cast<uint16_t>(ku_volts * 1000 + 0.5),
          1};
}

class FuzzyPdi {
 public:
  // Takes settings for a control period of 1..50 ms, and begins anew. false: refusal() says why.
  bool begin(const fuzzy_pdi::Settings& settings, uint8_t period_ms) {
    refusal_ = fuzzy_pdi::compile(settings, period_ms, joint_.coefficients);
    reset();
    return refusal_ == codes::Refusal::none;
  }

  // Forgets integral and last errors: after a pause, before the motor gets voltage again.
  void reset() { fuzzy_pdi::reset(joint_.coefficients, joint_.state); }

  // One control period: the voltage in mV, within +-limit_mv (up to 32767). While it would be beyond the limit on the
  // error's own side, the integral does not grow.
  int16_t update(int16_t wanted, int16_t is, uint16_t limit_mv) {
    output_ = fuzzy_pdi::step_error(joint_, fuzzy_pdi::difference(wanted, is), limit_mv);
    return output_.volts_mv;
  }

  codes::Refusal refusal() const { return refusal_; }
  const fuzzy_pdi::Output& output() const { return output_; }  // u_fuzzy, saturated

 private:
  fuzzy_pdi::Joint joint_ = {};
  fuzzy_pdi::Output output_ = {};
  codes::Refusal refusal_ = codes::Refusal::none;
};

// The size of a voltage as analogWrite() takes it, 0..255.
inline uint8_t duty(int16_t volts_mv, uint16_t supply_mv) {
  const uint16_t size = static_cast<uint16_t>(volts_mv < 0 ? -int32_t{volts_mv} : volts_mv);
  return size >= supply_mv ? uint8_t{255} : static_cast<uint8_t>(uint32_t{size} * 255 / supply_mv);
}

}  // namespace greywhale
