// Timer/counters 0..5. The count is worked out when somebody looks at it, and only interrupts that are enabled cost
// simulation time: a 20 kHz PWM is free.
#pragma once

#include <array>
#include <cstdint>

#include "interrupts.h"
#include "mcu.h"

namespace board {

class Timer {
 public:
  Timer(Mcu& mcu, const TimerMap& map, Interrupts& interrupts);
  void reset();

  unsigned number() const { return map_.number; }
  unsigned channels() const { return map_.channels; }
  // Mean level of the output-compare pin, 0..1, as the registers command it.
  double duty(unsigned channel);
  // The prescaler's counter was cleared (GTCCR).
  void restart_prescaler();

 private:
  enum class Wave : uint8_t { normal, clear_on_match, fast_pwm, phase_correct };
  // Their flags in TIFRn and their bits in TIMSKn are at these places.
  enum Event : unsigned { overflow, match_a, match_b, match_c, event_count };
  struct Mode {
    Wave wave;
    uint32_t top;
    bool top_is_ocra;
  };

  bool wide() const { return map_.wide; }
  uint32_t maximum() const { return wide() ? 0xFFFF : 0xFF; }
  static uint8_t bit(unsigned event) { return static_cast<uint8_t>(1u << event); }
  uint16_t address(unsigned offset) const { return static_cast<uint16_t>(map_.tccra + offset); }
  uint16_t ocr(unsigned channel) const { return address(wide() ? 8 + 2 * channel : 3 + channel); }
  uint32_t register_value(uint16_t reg) const;
  uint32_t compare(unsigned channel) const { return register_value(ocr(channel)); }
  Mode mode() const;
  uint32_t divider() const;
  unsigned vector(unsigned event) const {
    return event == overflow ? map_.match_a + map_.channels : map_.match_a + event - match_a;
  }

  // All of these count in ticks of the prescaled clock.
  uint64_t tick_at(uint64_t cycle) const { return (cycle - prescaler_origin_) / divider_; }
  uint64_t ticks_until(unsigned event) const;
  uint64_t ticks_until_phase(uint32_t phase) const;
  void advance(uint64_t ticks);

  void catch_up(uint64_t cycle);
  void configure(uint64_t cycle);
  void refresh_interrupts();
  void schedule_next();
  void on_event(uint64_t when);

  void write_config(uint16_t reg, uint8_t value);
  void write_high(uint16_t reg, uint8_t value);
  void write_low(uint16_t reg, uint8_t value);
  void write_flags(uint16_t reg, uint8_t value);
  void write_mask(uint16_t reg, uint8_t value);
  uint8_t read_count(uint16_t reg);
  uint8_t read_count_high(uint16_t reg);
  uint8_t read_flags(uint16_t reg);

  Mcu& mcu_;
  const TimerMap& map_;
  Interrupts& interrupts_;
  const uint16_t tccra_, tccrb_, tcnt_, icr_, flags_reg_, mask_reg_;  // addresses; of a wide one, of its low byte

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
