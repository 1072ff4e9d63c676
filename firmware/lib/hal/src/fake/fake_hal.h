// A board without hardware: what the tests put in, and what the firmware did.
#pragma once
#ifndef __AVR__
#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "../hal.h"

namespace hal {
namespace fake {

constexpr std::uint16_t eeprom_size = 1024;  // the Nano's
constexpr std::uint16_t eeprom_write_ticks = 4;
constexpr std::uint16_t full_duty = 400;  // the Mega's

struct FakeBoard {
  // in
  std::array<std::uint16_t, pot_count> counts;  // 10-bit
  ResetCause cause = ResetCause::power_on;
  std::deque<std::uint8_t> received;
  std::uint8_t lost = 0;
  std::uint8_t elapsed = 1;  // of the next tick
  bool late = false;         // the next tick finds the last one unfinished
  bool samples_ready = true;
  std::uint8_t probed = 0;
  std::array<int, pot_count> probe_beyond = {};  // what probing adds to each count
  bool estop_low = false;
  bool clutch_low = false;
  Driver last_driver = Driver::two_pwm_high;  // that it has pins for
  std::uint16_t age_us = 100;
  std::array<std::uint8_t, eeprom_size> eeprom;
  // out
  std::vector<std::uint8_t> sent;
  std::uint8_t tx_room = tx_capacity;      // places left; sending takes them, the test gives them back
  std::array<int, joint_count> duty = {};  // -full_duty..full_duty
  bool drivers = false;
  Driver driver = Driver::pwm_direction;
  bool drivers_when_sending = false;  // at the last tx_write()
  bool led = false;
  bool watchdog_on = false;
  unsigned watchdog_kicks = 0;
  unsigned eeprom_writes = 0;
  unsigned tx_misuse = 0;      // writes of no bytes or of more than there is room for
  unsigned eeprom_misuse = 0;  // reads or writes while a write was going on
  std::uint16_t eeprom_busy_ticks = 0;
  bool pending = false;

  FakeBoard();
};

extern FakeBoard board;
void power_on();    // a fresh board; EEPROM kept
void start_tick();  // what the timer does each millisecond

}  // namespace fake
}  // namespace hal
#endif  // __AVR__
