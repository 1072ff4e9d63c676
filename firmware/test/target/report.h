// Reports the cases of an on-target suite over the serial port in Unity's format, and ends the program.
#pragma once
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <hal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

inline uint16_t next_random() {  // xorshift, full period
  static uint16_t state = 1;
  state = static_cast<uint16_t>(state ^ (state << 7));
  state = static_cast<uint16_t>(state ^ (state >> 9));
  state = static_cast<uint16_t>(state ^ (state << 8));
  return state;
}

// A whole tick's duties towards the hardware; whether it had to be told that the one before was late.
inline bool finish_tick() {
  const bool late = hal::tick_begin().late;
  hal::release_pots(0);
  hal::end_pull_ups();
  hal::tick_end();
  return late;
}

namespace report {

static uint16_t cases = 0, failed = 0;

inline void print(const char* text) {
  while (*text) {
    while (hal::tx_free() == 0) {
    }
    if (hal::tick_pending()) finish_tick();  // else it would be taken for a hang
    hal::tx_write(reinterpret_cast<const uint8_t*>(text++), 1);
  }
}

inline void print(long number) {
  char digits[12];
  print(ltoa(number, digits, 10));
}

inline const char* file_name(const char* path) {
  const char* slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

// One line a case: the values are printed when they differ from what was wanted.
inline void check(const char* file, int line, const char* name, long value, long low, long high) {
  ++cases;
  print(file_name(file));
  print(":");
  print(static_cast<long>(line));
  print(":");
  print(name);
  if (value >= low && value <= high) {
    print(":PASS\n");
    return;
  }
  ++failed;
  print(":FAIL: ");
  print(value);
  print(" is not within ");
  print(low);
  print("..");
  print(high);
  print("\n");
}

inline void end() {
  print(static_cast<long>(cases));
  print(" Tests ");
  print(static_cast<long>(failed));
  print(" Failures 0 Ignored\n");
  while (hal::tx_free() != hal::tx_capacity) {
  }
  UCSR0A |= 1 << TXC0;
  while (!(UCSR0A & (1 << UDRE0))) {
  }
  __builtin_avr_delay_cycles(400);  // the last byte is still on the wire
  cli();
  sleep_enable();
  sleep_cpu();
}

}  // namespace report

inline void wait_for_tick() {
  while (!hal::tick_pending()) {
  }
}

// Printing takes longer than a tick: after this, ticks are in time again and the next one has just been finished.
inline void catch_up() {
  finish_tick();
  wait_for_tick();
  finish_tick();
  wait_for_tick();
  finish_tick();
}

#define WITHIN(name, value, low, high) \
  report::check(__FILE__, __LINE__, name, static_cast<long>(value), static_cast<long>(low), static_cast<long>(high))
#define EQUAL(name, value, wanted) WITHIN(name, value, wanted, wanted)
