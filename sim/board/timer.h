// SPDX-License-Identifier: GPL-3.0-or-later
// Timer/counters 0..5. The count is worked out when somebody looks at it, and only interrupts that are enabled cost
// simulation time: a 20 kHz PWM is free.
#pragma once

#include <array>
#include <cstdint>

#include "interrupts.h"
#include "simavr.h"

namespace board {

class Timer {
 public:
  Timer(avr_t& avr, avr_timer_t& stock, Interrupts& interrupts);
  void reset();

  unsigned number() const { return number_; }
  unsigned channels() const { return channels_; }
  // Mean level of the output-compare pin, 0..1, as the registers command it.
  double duty(unsigned channel);
  // The prescaler's counter was cleared (GTCCR).
  void restart_prescaler();

 private:
  enum class Wave : uint8_t { normal, clear_on_match, fast_pwm, phase_correct };
  enum Event : unsigned { overflow, match_a, match_b, match_c, event_count };
  struct Mode {
    Wave wave;
    uint32_t top;
    bool top_is_ocra;
  };

  bool wide() const { return stock_.r_tcnth != 0; }
  uint32_t maximum() const { return wide() ? 0xFFFF : 0xFF; }
  uint32_t register_pair(uint16_t low, uint16_t high) const;
  uint32_t compare(unsigned channel) const;
  Mode mode() const;
  uint32_t divider() const;
  avr_int_vector_t& vector(unsigned event);

  // All of these count in ticks of the prescaled clock.
  uint64_t tick_at(uint64_t cycle) const { return (cycle - prescaler_origin_) / divider_; }
  uint64_t ticks_until(unsigned event) const;
  uint64_t ticks_until_phase(uint32_t phase) const;
  void advance(uint64_t ticks);

  void catch_up(uint64_t cycle);
  void configure(uint64_t cycle);
  void refresh_interrupts();
  void schedule_next();
  avr_cycle_count_t on_event(avr_cycle_count_t when);

  void write_config(uint16_t reg, uint8_t value);
  void write_high(uint16_t reg, uint8_t value);
  void write_low(uint16_t reg, uint8_t value);
  void write_flags(uint16_t reg, uint8_t value);
  void write_mask(uint16_t reg, uint8_t value);
  uint8_t read_count(uint16_t reg);
  uint8_t read_count_high(uint16_t reg);
  uint8_t read_flags(uint16_t reg);

  avr_t& avr_;
  avr_timer_t& stock_;  // simavr's own model: register addresses and interrupt vectors are used
  Interrupts& interrupts_;
  unsigned number_;
  unsigned channels_;
  uint16_t flags_reg_, mask_reg_;

  Mode mode_{};
  uint32_t divider_ = 0;  // 0: stopped
  bool has_run_ = false;
  uint64_t prescaler_origin_ = 0;
  uint64_t tick_ = 0;  // the tick that count_ and falling_ belong to
  uint32_t count_ = 0;
  bool falling_ = false;   // phase-correct modes: on the way down
  uint8_t temporary_ = 0;  // TEMP, the high byte of a 16-bit access
};

}  // namespace board
