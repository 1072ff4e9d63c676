// The output pins and PWM registers: at reset, and for given duties.
#include <hal.h>

#include "../report.h"

namespace {

constexpr uint8_t enable = 1 << PH6;
constexpr uint8_t pwm_h = (1 << PH3) | (1 << PH4) | (1 << PH5);
constexpr uint8_t directions[4] = {1 << PA0, 1 << PA2, 1 << PA4, 1 << PA6};
constexpr uint8_t all_directions = (1 << PA0) | (1 << PA2) | (1 << PA4) | (1 << PA6);
constexpr uint8_t second_l = (1 << PL3) | (1 << PL4) | (1 << PL5);
constexpr uint8_t pwm_mode = (1 << WGM33) | (1 << CS30);
constexpr uint8_t all_of_4 = (1 << COM4A1) | (1 << COM4B1) | (1 << COM4C1);

uint16_t compare(uint8_t joint) {
  switch (joint) {
    case 0: return OCR3A;
    case 1: return OCR4A;
    case 2: return OCR4B;
    default: return OCR4C;
  }
}

void at_reset() {       // before hal::begin(): what start-up code has done
  TIMSK0 = 1 << TOIE0;  // as Arduino's core leaves it
  const uint8_t port_h = PORTH, port_e = PORTE, port_a = PORTA, ddr_h = DDRH, ddr_e = DDRE, ddr_a = DDRA, ddr_l = DDRL;
  hal::begin();
  EQUAL("at_reset_enable_is_driven", ddr_h & enable, enable);
  EQUAL("at_reset_port_h_is_low", port_h & (enable | pwm_h), 0);
  EQUAL("at_reset_port_e_is_low", port_e & (1 << PE3), 0);
  EQUAL("at_reset_directions_are_low", port_a & all_directions, 0);
  EQUAL("at_reset_pwm_pins_are_driven", (ddr_h & pwm_h) | (ddr_e & (1 << PE3)), pwm_h | (1 << PE3));
  EQUAL("at_reset_directions_are_driven", ddr_a, all_directions);
  EQUAL("at_reset_second_inputs_are_not_driven", (ddr_e & (1 << PE4)) | (ddr_l & second_l), 0);
}

void after_begin() {
  EQUAL("drivers_stay_off", PORTH & enable, 0);
  for (uint8_t i = 0; i < 4; ++i) EQUAL("duty_is_0", compare(i), 0);
  EQUAL("timer_3_top_is_20_khz", ICR3, 400);
  EQUAL("timer_4_top_is_20_khz", ICR4, 400);
  EQUAL("timer_5_top_is_20_khz", ICR5, 400);
  EQUAL("no_timer_has_a_pin", TCCR3A | TCCR4A | TCCR5A, 0);
  EQUAL("no_pwm_interrupts", TIMSK3 | TIMSK4 | TIMSK5, 0);
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
        const uint8_t pair = static_cast<uint8_t>(directions[joint] | directions[joint] << 1);
        const uint8_t others = PORTA & static_cast<uint8_t>(~pair);
        set(joint, positive, size, way & 2);
        wrong_compare += compare(joint) != size;
        wrong_direction += (PORTA & pair) != (positive ? directions[joint] : directions[joint] << 1);
        disturbed += (PORTA & static_cast<uint8_t>(~pair)) != others;
      }
    }
    EQUAL("full_duty_is_the_timers_top", hal::full_duty(joint), 400);
  }
  EQUAL("compare_is_the_duty", wrong_compare, 0);
  EQUAL("direction_follows_the_sign", wrong_direction, 0);
  EQUAL("a_joint_leaves_the_others_alone", disturbed, 0);
}

uint16_t second_compare(uint8_t joint) {
  switch (joint) {
    case 0: return OCR3B;
    case 1: return OCR5A;
    case 2: return OCR5B;
    default: return OCR5C;
  }
}

// One of the inputs has the size; the other one, or with pauses high the inverse.
uint16_t wrong_pairs(bool high) {
  constexpr uint16_t sizes[] = {0, 1, 100, 255, 256, 399, 400};
  uint16_t wrong = 0;
  for (uint8_t joint = 0; joint < 4; ++joint) {
    for (const uint16_t size : sizes) {
      for (uint8_t way = 0; way < 4; ++way) {
        const bool positive = way & 1;
        set(joint, positive, size, way & 2);
        const uint16_t driven = high ? 400 : size, other = high ? static_cast<uint16_t>(400 - size) : 0;
        wrong += compare(joint) != (positive ? driven : other);
        wrong += second_compare(joint) != (positive ? other : driven);
      }
    }
  }
  return wrong;
}

// What is on just then: nobody serves the ticks here, so the next one turns the drivers off.
struct Timers {
  uint8_t enable, pins_3, pins_4, pins_5;
};

Timers switch_on() {
  hal::set_drivers(true);
  return {static_cast<uint8_t>(PORTH & enable), TCCR3A, TCCR4A, TCCR5A};
}

void release() {
  for (uint8_t joint = 0; joint < 4; ++joint) hal::set_duty(joint, true, 0);
}

void pwm_and_two_directions() {
  hal::choose_driver(hal::Driver::pwm_two_directions);
  EQUAL("both_directions_are_driven", DDRA, 0xff);
  EQUAL("no_second_pwm", (DDRE & (1 << PE4)) | (DDRL & second_l), 0);
  duties();
}

void two_pwm() {
  release();
  hal::choose_driver(hal::Driver::two_pwm_low);
  EQUAL("directions_are_let_go", DDRA, 0);
  EQUAL("second_inputs_are_driven", DDRL & second_l, second_l);
  EQUAL("second_input_0_is_driven", DDRE & (1 << PE4), 1 << PE4);
  EQUAL("pauses_low", wrong_pairs(false), 0);
  release();
  const Timers on = switch_on();
  EQUAL("timer_3_has_both_pins", on.pins_3, (1 << COM3A1) | (1 << COM3B1));
  EQUAL("timer_5_has_its_pins", on.pins_5, (1 << COM5A1) | (1 << COM5B1) | (1 << COM5C1));
  EQUAL("timer_5_mode_8_no_prescaler", TCCR5B, pwm_mode);
  hal::set_drivers(false);
  EQUAL("no_timer_keeps_a_pin", TCCR3A | TCCR4A | TCCR5A, 0);
  EQUAL("all_motor_pins_are_low", (PORTE & ((1 << PE3) | (1 << PE4))) | (PORTH & pwm_h) | (PORTL & second_l), 0);
  hal::choose_driver(hal::Driver::two_pwm_high);
  EQUAL("pauses_high", wrong_pairs(true), 0);
  release();
  hal::choose_driver(hal::Driver::pwm_direction);
  EQUAL("second_inputs_are_let_go", (DDRE & (1 << PE4)) | (DDRL & second_l), 0);
  EQUAL("one_direction_again", DDRA, all_directions);
  release();
}

void drivers() {
  const Timers on = switch_on();
  EQUAL("drivers_on", on.enable, enable);
  EQUAL("timer_3_mode_8_no_prescaler", TCCR3B, pwm_mode);
  EQUAL("timer_4_mode_8_no_prescaler", TCCR4B, pwm_mode);
  EQUAL("timer_3_drives_its_pin", on.pins_3, 1 << COM3A1);
  EQUAL("timer_4_drives_its_pins", on.pins_4, all_of_4);
  EQUAL("timer_5_has_no_pin", on.pins_5, 0);
  hal::set_drivers(false);
  EQUAL("drivers_off", PORTH & enable, 0);
  EQUAL("off_no_timer_has_a_pin", TCCR3A | TCCR4A, 0);
  hal::set_led(true);
  EQUAL("led_on", PORTB & (1 << PB7), 1 << PB7);
  hal::set_led(false);
  EQUAL("led_off", PORTB & (1 << PB7), 0);
}

}  // namespace

int main() {
  at_reset();
  after_begin();
  duties();
  drivers();
  pwm_and_two_directions();
  two_pwm();
  drivers();
  report::end();
}
