// A board inside a web page: what its surroundings put in and take out. They make its time too: no cycles are counted,
// and no tick is late.
#pragma once
#ifdef __wasm__
#include <array>
#include <cstdint>

#include "../hal.h"

namespace hal {
namespace web {

constexpr std::uint16_t eeprom_size = 1024;  // the Nano's
constexpr std::uint16_t full_duty = 400;     // the Mega's
constexpr unsigned conversions = pot_count * conversions_per_pot;

// The levels at one motor's driver, duties 0..full_duty. Pins that its driver does not take are low.
struct MotorPins {
  std::uint16_t pwm, second_pwm;
  bool direction, second_direction;
};

using Eeprom = std::array<std::uint8_t, eeprom_size>;

void power_on(ResetCause cause);  // a fresh board; EEPROM kept
void power_off();                 // a byte that was being written is left erased

void start_tick();                               // what the timer does each millisecond
void set_age(std::uint16_t us);                  // of this tick
void convert(std::uint8_t pot, unsigned count);  // one conversion, 10 bits; a tick has all of them
std::uint8_t probed();                           // the pot that this tick probes
void probe(unsigned count);                      // what it read
void press_estop(bool pressed);
void press_clutch(bool pressed);

bool receive(std::uint8_t byte);  // from the host; false where there was no room, which the firmware hears of
bool take_sent(std::uint8_t& byte);

bool drivers_on();  // the enable pin
MotorPins motor_pins(std::uint8_t joint);
Eeprom& eeprom();
unsigned eeprom_writes();  // bytes written since the module was loaded

}  // namespace web
}  // namespace hal
#endif  // __wasm__
