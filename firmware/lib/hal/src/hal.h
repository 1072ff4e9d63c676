// The hardware as the rest of the firmware sees it: plain functions. Each target links one implementation of them.
// avr/ serves the two boards and holds every register access; fake/ serves unit tests on a computer,
// web/ a bench inside a web page.
#pragma once
#include <codes/codes.h>
#include <stdint.h>

namespace hal {

constexpr uint8_t joint_count = 4;
constexpr uint8_t pot_count = 8;            // 0..3 leader, 4..7 follower
constexpr uint8_t conversions_per_pot = 4;  // summed each tick
constexpr uint16_t rail_mark = 0x1000;      // above every sum

// 1 << pot, in the same few cycles for each.
inline uint8_t pot_bit(uint8_t pot) {
  uint8_t bit = pot & 1 ? 2 : 1;
  if (pot & 2) bit = static_cast<uint8_t>(bit << 2);
  if (pot & 4) bit = static_cast<uint8_t>(bit << 4);
  return bit;
}

using codes::Board;
Board board_id();  // unknown for one that has no name yet

using codes::ResetCause;
ResetCause reset_cause();  // watchdog after a hang, by whatever means the program was started anew

// Takes timers, ADC and serial port over from the framework. Outputs have been low and drivers off since the reset.
void begin();

// --- The tick, from a 1 kHz timer interrupt. The interrupt itself turns the drivers off when a tick is not finished in
// time.
struct TickStart {
  uint8_t elapsed;  // ticks since the last tick_begin(): 1 unless some were missed
  bool late;        // the tick before this one was not finished in time, or samples were not complete
};
bool tick_pending();
TickStart tick_begin();
void tick_end();
void run_tick();         // calls firmware_tick(), which main.cpp defines; no other caller may
uint16_t tick_age_us();  // time since the timer started this tick, resolution 4 us

// For every pot the sum of four 10-bit conversions, all made during the last tick; null when there are no new sums.
// Each conversion of 0..3 or 1020..1023 adds a rail_mark: without it, no sum would show a wire that opens in the middle
// of a tick. Release the sums before tick_end(): until then they stay as they are.
const uint16_t* pot_sums();
// The pot is probed: an input without a wire keeps what the converter's capacitor held, and reads like the pot before
// it; one whose wire touches another's reads what both of them say. So a pot is read once more after ground, which
// empties the capacitor, with the pull-ups of all other inputs on. They stay on until end_pull_ups().
void release_pots(uint8_t probed);
void end_pull_ups();  // 5 us later at least: by then the input has been sampled

struct Probe {
  uint8_t pot;    // pot_count or more: the tick had no time for it
  uint8_t count;  // what it read, the upper 8 of 10 bits
  uint8_t usual;  // the same of the mean of its last sum
};
Probe last_probe();

// --- Motor drivers: the signals that each motor's driver takes. The numbers are those of the parameter `driver`.
enum class Driver : uint8_t {
  pwm_direction,
  pwm_two_directions,
  two_pwm_low,   // between pulses both inputs are low
  two_pwm_high,  // between pulses both inputs are high
};
bool has_driver(Driver driver);     // whether this board has the pins
void choose_driver(Driver driver);  // one that it has; another one than before only while the drivers are off

// --- Outputs. A duty is a size of 0..full_duty(joint), the PWM's own steps, and a sign: positive sets the direction
// pin, or takes the first of two inputs. set_duty<joint>() is the same for a joint known at compile time, in a few
// cycles.
uint16_t full_duty(uint8_t joint);
void set_duty(uint8_t joint, bool positive, uint16_t size);
template <uint8_t joint>
void set_duty(bool positive, uint16_t size);
// The enable pin, and the PWM on the motors' pins: off, all of them are low, also for drivers that have no enable
// input.
void set_drivers(bool on);
void set_led(bool on);

// --- The inputs of the emergency stop and of the clutch's pedal, which their pull-ups hold high: their levels now.
bool estop_low();
bool clutch_low();

// --- Serial port, interrupt-driven both ways.
constexpr uint8_t tx_capacity = 127;
constexpr uint8_t rx_capacity = 127;
bool rx_available();
uint8_t rx_read();  // only when rx_available()
uint8_t tx_free();
void tx_write(const uint8_t* bytes, uint8_t count);  // 1..tx_free() of them
uint8_t rx_lost();                                   // how often bytes were lost since the last call, at most 255

// --- EEPROM, one byte at a time. A write takes about 3.4 ms in the background.
bool eeprom_busy();
uint8_t eeprom_read(uint16_t address);                     // only when not busy
void eeprom_begin_write(uint16_t address, uint8_t value);  // only when not busy

// --- Watchdog of 15 ms (the tick's interrupt forestalls it after ten ticks that nobody has begun), and idle sleep
// until a tick is pending or a byte has come.
void watchdog_start();
void watchdog_kick();
void idle();

}  // namespace hal

#ifdef __AVR__
#include "avr/inline.h"
#else
extern "C" void firmware_tick();
inline void hal::run_tick() { firmware_tick(); }
template <uint8_t joint>
inline void hal::set_duty(bool positive, uint16_t size) {
  set_duty(joint, positive, size);
}
#endif
