// What a page calls. Numbers and bytes go through two buffers in the module's memory; a caller keeps to the ranges that
// are said here, for nothing is checked twice. Pots are 0..3 leader, 4..7 follower.
#include <web/web_hal.h>

#include <array>
#include <cstdint>
#include <optional>

#include "bench.h"

#define EXPORT(name) __attribute__((export_name(#name)))

namespace greywhale::web {
namespace {

constexpr std::size_t kBytes = 4096;

std::array<double, 256> numbers;
std::array<std::uint8_t, kBytes> bytes;
std::optional<Bench> bench;

// Reads the numbers in the order in which they are declared.
class Reader {
 public:
  double next() { return numbers.at(at_++); }
  arm::Sensor<double> sensor() { return {next(), next()}; }

  arm::ArmParameters arm() {
    arm::ArmParameters arm{};
    for (arm::Link& link : arm.links) link = {next(), next(), next(), next(), next(), next()};
    arm.tip_mass = next();
    arm.gravity = next();
    for (arm::Joint<double>& joint : arm.joints) {
      joint.actuator = {next(), next(), next(), next()};
      joint.friction = {next(), next(), next(), next(), next()};
      joint.gear = {next(), next(), next(), next()};
      joint.stops = {next(), next()};
      joint.sensor = sensor();
    }
    arm.drive = {{next(), next()}, static_cast<int>(next())};
    return arm;
  }

  double pots(std::array<arm::Potentiometer, arm::kJoints>& pots) {
    for (arm::Potentiometer& pot : pots) pot = {next(), next(), next(), next(), next(), sensor()};
    return next();
  }

 private:
  std::size_t at_ = 0;
};

template <std::size_t N>
void show(std::size_t at, const std::array<double, N>& values) {
  for (const double value : values) numbers.at(at++) = value;
}

}  // namespace

extern "C" {

EXPORT(numbers) double* exported_numbers() { return numbers.data(); }
EXPORT(bytes) std::uint8_t* exported_bytes() { return bytes.data(); }  // 4096 of them
EXPORT(eeprom) std::uint8_t* exported_eeprom() { return hal::web::eeprom().data(); }
EXPORT(eeprom_size) unsigned exported_eeprom_size() { return hal::web::eeprom_size; }
EXPORT(eeprom_writes) unsigned exported_eeprom_writes() { return hal::web::eeprom_writes(); }

// A bench with power off: numbers are the arm, the leader's and the follower's potentiometers (Reader).
EXPORT(start) void exported_start(unsigned seed) {
  Reader reader;
  Parameters parameters{};
  parameters.arm = reader.arm();
  parameters.leader_pots_supply = reader.pots(parameters.leader_pots);
  parameters.follower_pots_supply = reader.pots(parameters.follower_pots);
  bench.emplace(parameters, seed);
}

// Lets so many slices of 250 us pass; how many bytes the board said, which then stand in the buffer. Up to 40 slices
// never say more than fits.
EXPORT(run) unsigned exported_run(unsigned slices) {
  for (; slices; --slices) bench->run_slice();
  std::vector<std::uint8_t>& said = bench->board.said();
  const unsigned count = static_cast<unsigned>(said.size());
  for (unsigned i = 0; i < count; ++i) bytes.at(i) = said[i];
  said.clear();
  return count;
}

// Takes bytes from the buffer to the board.
EXPORT(send) void exported_send(unsigned count) {
  for (unsigned i = 0; i < count; ++i) bench->board.send(bytes.at(i));
}

EXPORT(power) void exported_power(unsigned on) {
  if (!on) bench->board.power_off();
  else if (!bench->board.powered()) bench->board.power_on(hal::ResetCause::power_on);
}
EXPORT(reset) void exported_reset() { bench->board.power_on(hal::ResetCause::external); }
EXPORT(estop) void exported_estop(unsigned pressed) { hal::web::press_estop(pressed != 0); }
EXPORT(clutch) void exported_clutch(unsigned pressed) { hal::web::press_clutch(pressed != 0); }

// The leader is led to the first four numbers, rad.
EXPORT(lead) void exported_lead() { bench->person.lead({numbers[0], numbers[1], numbers[2], numbers[3]}); }
EXPORT(hold_inputs) void exported_hold_inputs() {  // mV
  Millivolts millivolts{};
  for (std::size_t pot = 0; pot < kPots; ++pot) millivolts[pot] = numbers[pot];
  bench->hold_inputs(millivolts);
}

EXPORT(inject) void exported_inject(unsigned pot, unsigned kind) {
  bench->pot_faults.inject(pot, static_cast<arm::PotFault>(kind));
}
EXPORT(swap) void exported_swap(unsigned one, unsigned other) { bench->pot_faults.swap(one, other); }
EXPORT(touch) void exported_touch(unsigned one, unsigned other) { bench->touch(one, other); }
EXPORT(set_wiring) void exported_set_wiring(unsigned pot, unsigned wiring) {
  bench->set_wiring(pot, static_cast<arm::Wiring>(wiring));
}
EXPORT(let_float) void exported_let_float(unsigned pot, unsigned floats) { bench->let_float(pot, floats != 0); }
EXPORT(wire_motor) void exported_wire_motor(unsigned joint, double gain, unsigned driver) {
  bench->wire_motor(joint, gain, driver);
}
EXPORT(change_supply) void exported_change_supply(double volts) { bench->change_supply(volts); }
EXPORT(share_supply) void exported_share_supply() { bench->share_supply(); }
EXPORT(load_tip) void exported_load_tip(double mass) { bench->load_tip(mass); }
EXPORT(scale_play) void exported_scale_play(double times) { bench->scale_play(times); }
EXPORT(scale_noise) void exported_scale_noise(double times) { bench->scale_noise(times); }
EXPORT(mend) void exported_mend() { bench->mend(); }

// Numbers become: voltages at the converter (8, mV), at the motors (4, V), leader and follower (4 each, rad), enable,
// and of each driver its duty 0..1 and its direction.
EXPORT(look) void exported_look() {
  show(0, bench->millivolts());
  show(8, bench->voltages());
  show(12, bench->person.angles());
  show(16, bench->follower());
  numbers[20] = hal::web::drivers_on();
  for (std::uint8_t joint = 0; joint < arm::kJoints; ++joint) {
    const hal::web::MotorPins pins = hal::web::motor_pins(joint);
    numbers[21 + joint] = static_cast<double>(pins.pwm) / hal::web::full_duty;
    numbers[25 + joint] = pins.direction;
  }
}
EXPORT(powered) unsigned exported_powered() { return bench->board.powered(); }
EXPORT(starts) unsigned exported_starts() { return bench->board.starts(); }

}  // extern "C"

}  // namespace greywhale::web
