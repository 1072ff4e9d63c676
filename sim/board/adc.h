// The analogue-to-digital converter: samples when the chip samples, and holds.
#pragma once

#include <array>
#include <cstdint>

#include "interrupts.h"
#include "mcu.h"

namespace board {

class Adc {
 public:
  static constexpr unsigned input_count = 8;

  Adc(Mcu& mcu, const Chip& chip, Interrupts& interrupts);
  void reset();

  // Voltages at ADC0..7 from now on. A conversion that has already sampled keeps what it took.
  void set_millivolts(const std::array<double, input_count>& millivolts);
  // Inputs without a wire, bit i for ADCi: such a one has no voltage of its own, and the sampling capacitor keeps what
  // the conversion before left on it.
  void set_floating(uint8_t inputs);
  // Inputs on one wire, with so many potentiometers' wipers on it: a pull-up of one of them pulls all.
  void set_joined(uint8_t inputs, unsigned wipers);
  uint64_t conversions() const { return conversions_; }

 private:
  bool running() const { return end_ != 0; }
  unsigned selected() const;
  double millivolts_at(unsigned mux) const;
  double reference_millivolts(unsigned admux) const;
  void start(uint64_t edge);
  void sample();
  void sample_if_due(uint64_t cycle);
  double pulled_up(unsigned input) const;
  void on_done(uint64_t when);

  void write_control(uint16_t reg, uint8_t value);
  void write_mux(uint16_t reg, uint8_t value);
  void write_port(uint16_t reg, uint8_t value);
  uint8_t read_low(uint16_t reg);
  uint8_t read_high(uint16_t reg);

  Mcu& mcu_;
  const Chip& chip_;
  Interrupts& interrupts_;

  std::array<double, input_count> millivolts_{};
  uint8_t floating_ = 0, joined_ = 0;
  unsigned wipers_ = 1;
  double charge_ = 0.0;      // mV on the sampling capacitor
  uint64_t enabled_at_ = 0;  // the prescaler counts from here
  bool first_ = true;
  bool result_locked_ = false;

  // The conversion under way
  uint64_t edge_ = 0;       // ADC clock edge it started at: channel and reference are fixed from here
  uint64_t sample_at_ = 0;  // the sample-and-hold closes
  uint64_t end_ = 0;        // 0: no conversion
  unsigned mux_ = 0;
  unsigned admux_ = 0;
  bool sampled_ = false;
  uint16_t held_ = 0;
  uint64_t conversions_ = 0;
};

}  // namespace board
