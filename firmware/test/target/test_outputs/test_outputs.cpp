// The output pins and PWM registers: at reset, and for given duties.
#include <Arduino.h>
#include <hal.h>

#include "../report.h"

namespace {

constexpr uint8_t enable = 1 << PH6;
constexpr uint8_t pwm_h = (1 << PH3) | (1 << PH4) | (1 << PH5);
constexpr uint8_t directions[4] = {1 << PA0, 1 << PA2, 1 << PA4, 1 << PA6};
constexpr uint8_t all_directions = (1 << PA0) | (1 << PA2) | (1 << PA4) | (1 << PA6);

uint16_t compare(uint8_t joint) {
  switch (joint) {
    case 0: return OCR3A;
    case 1: return OCR4A;
    case 2: return OCR4B;
    default: return OCR4C;
  }
}

void at_reset() {  // before hal::begin(): what start-up code has done
  const uint8_t port_h = PORTH, port_e = PORTE, port_a = PORTA, ddr_h = DDRH, ddr_e = DDRE, ddr_a = DDRA;
  hal::begin();
  EQUAL("at_reset_enable_is_driven", ddr_h & enable, enable);
  EQUAL("at_reset_port_h_is_low", port_h & (enable | pwm_h), 0);
  EQUAL("at_reset_port_e_is_low", port_e & (1 << PE3), 0);
  EQUAL("at_reset_directions_are_low", port_a & all_directions, 0);
  EQUAL("at_reset_pwm_pins_are_driven", (ddr_h & pwm_h) | (ddr_e & (1 << PE3)), pwm_h | (1 << PE3));
  EQUAL("at_reset_directions_are_driven", ddr_a & all_directions, all_directions);
}

void after_begin() {
  EQUAL("drivers_stay_off", PORTH & enable, 0);
  for (uint8_t i = 0; i < 4; ++i) EQUAL("duty_is_0", compare(i), 0);
  EQUAL("timer_3_top_is_20_khz", ICR3, 400);
  EQUAL("timer_4_top_is_20_khz", ICR4, 400);
  EQUAL("timer_3_mode_8_no_prescaler", TCCR3B, (1 << WGM33) | (1 << CS30));
  EQUAL("timer_4_mode_8_no_prescaler", TCCR4B, (1 << WGM43) | (1 << CS40));
  EQUAL("timer_3_drives_its_pin", TCCR3A, 1 << COM3A1);
  EQUAL("timer_4_drives_its_pins", TCCR4A, (1 << COM4A1) | (1 << COM4B1) | (1 << COM4C1));
  EQUAL("no_pwm_interrupts", TIMSK3 | TIMSK4, 0);
  EQUAL("no_millis_interrupt", TIMSK0, (1 << OCIE0A) | (1 << OCIE0B));
}

template <uint8_t joint>
void set(bool positive, uint16_t size, bool inlined) {
  if (inlined) hal::set_duty<joint>(positive, size);
  else hal::set_duty(joint, positive, size);
}

void set(uint8_t joint, bool positive, uint16_t size, bool inlined) {
  switch (joint) {
    case 0: set<0>(positive, size, inlined); break;
    case 1: set<1>(positive, size, inlined); break;
    case 2: set<2>(positive, size, inlined); break;
    default: set<3>(positive, size, inlined); break;
  }
}

void duties() {
  constexpr uint16_t sizes[] = {0, 1, 100, 255, 256, 399, 400};
  uint16_t wrong_compare = 0, wrong_direction = 0, disturbed = 0;
  for (uint8_t joint = 0; joint < 4; ++joint) {
    for (const uint16_t size : sizes) {
      for (uint8_t way = 0; way < 4; ++way) {
        const bool positive = way & 1;
        const uint8_t others = PORTA & static_cast<uint8_t>(~directions[joint]);
        set(joint, positive, size, way & 2);
        wrong_compare += compare(joint) != size;
        wrong_direction += ((PORTA & directions[joint]) != 0) != positive;
        disturbed += (PORTA & static_cast<uint8_t>(~directions[joint])) != others;
      }
    }
    EQUAL("full_duty_is_the_timers_top", hal::full_duty(joint), 400);
  }
  EQUAL("compare_is_the_duty", wrong_compare, 0);
  EQUAL("direction_follows_the_sign", wrong_direction, 0);
  EQUAL("a_joint_leaves_the_others_alone", disturbed, 0);
}

void drivers() {
  hal::set_drivers(true);
  EQUAL("drivers_on", PORTH & enable, enable);
  hal::set_drivers(false);
  EQUAL("drivers_off", PORTH & enable, 0);
  hal::set_led(true);
  EQUAL("led_on", PORTB & (1 << PB7), 1 << PB7);
  hal::set_led(false);
  EQUAL("led_off", PORTB & (1 << PB7), 0);
}

}  // namespace

void setup() {
  at_reset();
  after_begin();
  duties();
  drivers();
  report::end();
}

void loop() {}
