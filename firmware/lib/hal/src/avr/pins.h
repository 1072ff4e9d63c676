// Names, interrupts, pins, ports and timers of the two boards. Only this file asks which board it is built for.
#pragma once
#ifdef __AVR__
#include <avr/io.h>

// The ATmega328P has one USART and no number in the names of its interrupts.
#if defined(__AVR_ATmega2560__)
#define RECEIVED_vect USART0_RX_vect
#define SENDABLE_vect USART0_UDRE_vect
#elif defined(__AVR_ATmega328P__)
#define RECEIVED_vect USART_RX_vect
#define SENDABLE_vect USART_UDRE_vect
#else
#error "greywhale's hal knows the ATmega2560 and the ATmega328P"
#endif

#ifndef __ASSEMBLER__  // hal.h includes what follows, at its end
#include <stdint.h>

namespace hal {
namespace pins {

constexpr uint16_t pwm_top = 400;  // 16 MHz / (2 * 400) = 20 kHz, phase and frequency correct

// Turns the drivers off in a few cycles; safe in an interrupt and before any C++ is set up. The motors' pins leave
// their timers too, so they are low, and stay so until drivers_on(): not every driver has an enable input.
inline void drivers_off();

#if defined(__AVR_ATmega2560__)

constexpr Board board = Board::mega2560;
constexpr uint8_t enable_bit = 1 << PH6, led_bit = 1 << PB7, estop_bit = 1 << PB4;
constexpr uint8_t clutch_bit = 1 << PB5;
constexpr uint8_t directions = (1 << PA0) | (1 << PA2) | (1 << PA4) | (1 << PA6);
constexpr uint8_t pwm_e = 1 << PE3, pwm_h = (1 << PH3) | (1 << PH4) | (1 << PH5);
// What only some drivers need. These pins are inputs until a parameter set asks for them.
constexpr Driver last_driver = Driver::two_pwm_high;
constexpr uint8_t second_directions = (1 << PA1) | (1 << PA3) | (1 << PA5) | (1 << PA7);
constexpr uint8_t second_pwm_e = 1 << PE4, second_pwm_l = (1 << PL3) | (1 << PL4) | (1 << PL5);

inline bool has_two_pwm(Driver driver) { return driver >= Driver::two_pwm_low; }

inline void drivers_off() {
  PORTH = static_cast<uint8_t>(PORTH & ~enable_bit);
  TCCR3A = TCCR4A = TCCR5A = 0;
}

// The motors' pins go to their timers. A pin's latch may have kept a 1 since it left its timer: a forced match, which
// only a timer outside of its PWM mode takes, makes it 0.
inline void drivers_on(Driver driver) {
  TCCR3B = TCCR4B = TCCR5B = 0;
  TCCR3A = has_two_pwm(driver) ? (1 << COM3A1) | (1 << COM3B1) : 1 << COM3A1;
  TCCR4A = (1 << COM4A1) | (1 << COM4B1) | (1 << COM4C1);
  if (has_two_pwm(driver)) TCCR5A = (1 << COM5A1) | (1 << COM5B1) | (1 << COM5C1);
  TCCR3C = TCCR4C = TCCR5C = (1 << FOC3A) | (1 << FOC3B) | (1 << FOC3C);
  TCCR3B = TCCR4B = TCCR5B = (1 << WGM33) | (1 << CS30);  // mode 8, no prescaler
  PORTH = static_cast<uint8_t>(PORTH | enable_bit);
}

inline void wire(Driver driver) {
  const bool two = has_two_pwm(driver);
  DDRA = two ? 0 : driver == Driver::pwm_direction ? directions : directions | second_directions;
  DDRE = two ? pwm_e | second_pwm_e : pwm_e;
  DDRL = two ? second_pwm_l : 0;
}
inline void led(bool on) {
  if (on) PORTB |= led_bit;
  else PORTB &= static_cast<uint8_t>(~led_bit);
}

inline void all_outputs_low() {
  PORTH = 0;
  DDRH = enable_bit | pwm_h;
  PORTE = 0;
  DDRE = pwm_e;
  PORTA = 0;
  DDRA = directions;
  PORTB = estop_bit | clutch_bit;  // inputs with their pull-ups
  DDRB = led_bit;
}

// Compare registers at 0 keep the pins low when they are handed to the timers.
inline void start_pwm() {
  TIMSK3 = TIMSK4 = TIMSK5 = 0;
  TCCR3A = TCCR4A = TCCR5A = 0;
  TCCR3B = TCCR4B = TCCR5B = 0;
  ICR3 = ICR4 = ICR5 = pwm_top;
  OCR3A = OCR3B = OCR4A = OCR4B = OCR4C = OCR5A = OCR5B = OCR5C = 0;
  TCNT3 = TCNT4 = TCNT5 = 0;
}

inline void stop_unused_timers() { TCCR1B = TCCR2B = 0; }

inline void pull_up_pots(uint8_t pots) { PORTF = pots; }
inline bool estop_low() { return (PINB & estop_bit) == 0; }
inline bool clutch_low() { return (PINB & clutch_bit) == 0; }

// Single-bit instructions, so interrupts may touch the same port. Of two directions one goes low before the other goes
// high.
template <uint8_t first, uint8_t second>
inline void direction_pair(bool positive) {
  if (positive) {
    PORTA &= static_cast<uint8_t>(~(1 << second));
    PORTA |= 1 << first;
  } else {
    PORTA &= static_cast<uint8_t>(~(1 << first));
    PORTA |= 1 << second;
  }
}

inline void direction(uint8_t joint, bool positive) {
  switch (joint) {
    case 0: direction_pair<PA0, PA1>(positive); break;
    case 1: direction_pair<PA2, PA3>(positive); break;
    case 2: direction_pair<PA4, PA5>(positive); break;
    default: direction_pair<PA6, PA7>(positive); break;
  }
}

inline uint16_t top(uint8_t) { return pwm_top; }

inline void compare(uint8_t joint, uint16_t value) {
  switch (joint) {
    case 0: OCR3A = value; break;
    case 1: OCR4A = value; break;
    case 2: OCR4B = value; break;
    default: OCR4C = value; break;
  }
}

// Both compare registers of a motor with two PWM inputs; those of joints 1 to 3 follow each other (checked below).
inline void compare_pair(uint8_t joint, uint16_t first, uint16_t second) {
  *(joint == 0 ? &OCR3A : &OCR4A + (joint - 1)) = first;
  *(joint == 0 ? &OCR3B : &OCR5A + (joint - 1)) = second;
}

#else

constexpr Board board = Board::nano328;
constexpr uint8_t enable_bit = 1 << PB4, led_bit = 1 << PB5, estop_bit = 1 << PD5;
constexpr uint8_t clutch_bit = 1 << PD6;
constexpr uint8_t directions_d = (1 << PD2) | (1 << PD4) | (1 << PD7), direction_b = 1 << PB0;
constexpr uint16_t pwm_top8 = 255;
constexpr uint8_t pwm_b = (1 << PB1) | (1 << PB2) | (1 << PB3), pwm_d = 1 << PD3;

constexpr Driver last_driver = Driver::pwm_direction;

inline bool has_two_pwm(Driver) { return false; }

inline void drivers_off() {
  PORTB &= static_cast<uint8_t>(~enable_bit);
  TCCR1A = 0;
  TCCR2A = 1 << WGM20;
}

// As on the Mega.
inline void drivers_on(Driver) {
  TCCR1B = TCCR2B = TCCR2A = 0;
  TCCR1A = (1 << COM1A1) | (1 << COM1B1);
  TCCR2A = (1 << COM2A1) | (1 << COM2B1);
  TCCR1C = (1 << FOC1A) | (1 << FOC1B);
  TCCR2B = (1 << FOC2A) | (1 << FOC2B);
  TCCR1B = (1 << WGM13) | (1 << CS10);  // mode 8, no prescaler
  TCCR2A = (1 << COM2A1) | (1 << COM2B1) | (1 << WGM20);
  TCCR2B = 1 << CS20;  // mode 1, no prescaler
  PORTB |= enable_bit;
}

inline void wire(Driver) {}
inline void compare_pair(uint8_t, uint16_t, uint16_t) {}
inline void led(bool on) {
  if (on) PORTB |= led_bit;
  else PORTB &= static_cast<uint8_t>(~led_bit);
}

inline void all_outputs_low() {
  PORTB = 0;
  DDRB = enable_bit | led_bit | pwm_b | direction_b;
  PORTD = estop_bit | clutch_bit;  // inputs with their pull-ups
  DDRD = pwm_d | directions_d;
}

// Drivers on, timer 1 runs at 20 kHz, as on the Mega. Timer 2 has 8 bits only, and both its compare registers drive
// pins: 31.4 kHz, top 255.
inline void start_pwm() {
  TIMSK1 = TIMSK2 = 0;
  TCCR1B = TCCR2B = 0;
  ICR1 = pwm_top;
  OCR1A = OCR1B = 0;
  OCR2A = OCR2B = 0;
  TCNT1 = 0;
  TCNT2 = 0;
  TCCR1A = TCCR2A = 0;
}

inline void stop_unused_timers() {}

inline void pull_up_pots(uint8_t pots) { PORTC = pots & 0x3f; }  // ADC6 and ADC7 have no pull-ups
inline bool estop_low() { return (PIND & estop_bit) == 0; }
inline bool clutch_low() { return (PIND & clutch_bit) == 0; }

inline void direction(uint8_t joint, bool positive) {
  switch (joint) {  // single-bit instructions, so interrupts may touch the same port
    case 0:
      if (positive) PORTD |= 1 << PD2;
      else PORTD &= static_cast<uint8_t>(~(1 << PD2));
      break;
    case 1:
      if (positive) PORTD |= 1 << PD4;
      else PORTD &= static_cast<uint8_t>(~(1 << PD4));
      break;
    case 2:
      if (positive) PORTD |= 1 << PD7;
      else PORTD &= static_cast<uint8_t>(~(1 << PD7));
      break;
    default:
      if (positive) PORTB |= direction_b;
      else PORTB &= static_cast<uint8_t>(~direction_b);
      break;
  }
}

inline uint16_t top(uint8_t joint) { return joint < 2 ? pwm_top : pwm_top8; }

inline void compare(uint8_t joint, uint16_t value) {
  switch (joint) {
    case 0: OCR1A = value; break;
    case 1: OCR1B = value; break;
    case 2: OCR2A = static_cast<uint8_t>(value); break;
    default: OCR2B = static_cast<uint8_t>(value); break;
  }
}

#endif

}  // namespace pins
}  // namespace hal
// An address is a number for the assembler only: for C++ it is a pointer's, which no compiler need take as a constant.
#elif defined(__AVR_ATmega2560__)
#if OCR4B != OCR4A + 2 || OCR4C != OCR4A + 4 || OCR5B != OCR5A + 2 || OCR5C != OCR5A + 4
#error "the compare registers of joints 1 to 3 do not follow each other: see compare_pair()"
#endif
#endif  // __ASSEMBLER__
#endif  // __AVR__
