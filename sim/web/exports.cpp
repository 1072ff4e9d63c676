// What a page calls: a board with its program, and the bench around it. Numbers and bytes go through two buffers in the
// module's memory; a caller keeps to the ranges that are said here, for nothing is checked twice. Pots are 0..3 leader,
// 4..7 follower.
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "bench/bench.h"
#include "bench/simulated_board.h"
#include "board/board.h"

#define EXPORT(name) __attribute__((export_name(#name)))

namespace greywhale::bench {
namespace {

constexpr std::size_t kBytes = 65'536;
constexpr std::uint64_t kSeed = 1;  // of the noise, and of what is in the memory when the power comes
constexpr const char* kChips[] = {"atmega2560", "atmega328p"};

std::array<double, 256> numbers;
std::array<std::uint8_t, kBytes> bytes;

std::string given(unsigned count) { return {reinterpret_cast<const char*>(bytes.data()), count}; }

unsigned show(const std::string& text) {
  std::copy(text.begin(), text.end(), bytes.begin());
  return static_cast<unsigned>(text.size());
}

// Reads the numbers in the order in which they are declared.
class Reader {
 public:
  double next() { return numbers.at(at_++); }
  unsigned whole() { return static_cast<unsigned>(next()); }
  char letter() { return static_cast<char>(next()); }
  Pin pin() { return {letter(), whole()}; }

  Wiring wiring() {
    Wiring wiring{};
    wiring.enable = pin();
    for (MotorWires& motor : wiring.motors) motor = {{whole(), letter()}, pin()};
    wiring.estop = pin();
    wiring.clutch = pin();
    return wiring;
  }

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
      joint.driver = {next(), next()};
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

Electrics electrics_of(const arm::ArmParameters& arm) {
  Electrics electrics{Chip::sign_magnitude, arm.drive.supply.volts, {}, Person::kAllJoints};
  for (std::size_t joint = 0; joint < arm::kJoints; ++joint) {
    const arm::Actuator<double>& motor = arm.joints[joint].actuator;
    electrics.emf[joint] = motor.torque_per_volt * motor.resistance;
  }
  return electrics;
}

// All that stands in a page.
struct Stand {
  Stand(const char* chip, const Wiring& wiring, const arm::ArmParameters& arm, const Pots& pots)
      : board(chip),
        seam(board, wiring),
        person(still_motion(Four{}), kSlice),
        own(arm, kSeed),
        bench(seam, wiring, person, own, &own, pots, kSeed, electrics_of(arm)) {}

  board::Board board;
  SimulatedBoard seam;
  Person person;
  OwnArm own;
  Bench bench;
};

std::unique_ptr<Stand> stand;

}  // namespace

extern "C" {

EXPORT(numbers) double* exported_numbers() { return numbers.data(); }
EXPORT(bytes) std::uint8_t* exported_bytes() { return bytes.data(); }
EXPORT(bytes_size) unsigned exported_bytes_size() { return kBytes; }

// A bench with power off and a blank board, 0 Mega or 1 Nano: numbers are the wiring, the arm, the leader's and the
// follower's potentiometers (Reader).
EXPORT(start) void exported_start(unsigned chip) {
  Reader reader;
  const Wiring wiring = reader.wiring();
  const arm::ArmParameters arm = reader.arm();
  Pots pots{};
  pots.leader_supply = reader.pots(pots.leader);
  pots.follower_supply = reader.pots(pots.follower);
  stand = std::make_unique<Stand>(kChips[chip], wiring, arm, pots);
}

// Writes a program from the buffer to this address of the flash; the reset leads to a bootloader.
EXPORT(program) void exported_program(unsigned address, unsigned count, unsigned bootloader) {
  stand->board.write_program({{address, given(count)}}, "program", bootloader != 0);
}

// Lets so many slices of 250 us pass, up to 2000; how many bytes the board said, which then stand in the buffer.
EXPORT(run) unsigned exported_run(unsigned slices) {
  stand->bench.run_slices(slices);
  return show(stand->board.uart().receive());
}
EXPORT(crashed) unsigned exported_crashed() { return stand->board.state() == board::RunState::crashed; }

// Takes bytes from the buffer to the board.
EXPORT(send) void exported_send(unsigned count) { stand->board.send(given(count)); }

EXPORT(power) void exported_power(unsigned on) {
  if (!on) stand->board.power_off(kSeed);
  else if (!stand->board.powered()) stand->board.power_on(kSeed);
}
EXPORT(reset) void exported_reset() { stand->board.reset(); }
EXPORT(powered) unsigned exported_powered() { return stand->board.powered(); }
EXPORT(starts) unsigned exported_starts() { return static_cast<unsigned>(stand->board.stats().resets); }
EXPORT(in_bootloader) unsigned exported_in_bootloader() { return stand->board.in_bootloader(); }
EXPORT(cycle) double exported_cycle() { return static_cast<double>(stand->board.cycle()); }

// The board's EEPROM, to and from the buffer; how many bytes it has.
EXPORT(read_eeprom) unsigned exported_read_eeprom() { return show(stand->board.eeprom().content()); }
EXPORT(write_eeprom) void exported_write_eeprom(unsigned count) { stand->board.eeprom().set_content(given(count)); }

EXPORT(press_estop) void exported_press_estop(unsigned pressed) { stand->bench.press_estop(pressed != 0); }
EXPORT(press_clutch) void exported_press_clutch(unsigned pressed) { stand->bench.press_clutch(pressed != 0); }

// The leader is led to the first four numbers, rad.
EXPORT(lead) void exported_lead() { stand->person.lead({numbers[0], numbers[1], numbers[2], numbers[3]}); }

// What a calibration asks of hands: how many seconds they take, 0 where they are not free for it.
EXPORT(turn) double exported_turn(unsigned pot) {
  return stand->person.has_free_hands() ? stand->person.turn(pot) : 0.0;
}
// Both arms at the first four numbers, rad. Hands on their way to another pose go to this one.
EXPORT(pose) double exported_pose() {
  return stand->person.hold ? stand->person.pose({numbers[0], numbers[1], numbers[2], numbers[3]}) : 0.0;
}
EXPORT(hang) double exported_hang() { return stand->person.hold ? stand->person.hang() : 0.0; }

EXPORT(inject) void exported_inject(unsigned pot, unsigned kind) {
  stand->bench.inject(pot, static_cast<arm::PotFault>(kind));
}
EXPORT(swap) void exported_swap(unsigned one, unsigned other) { stand->bench.swap(one, other); }
EXPORT(touch) void exported_touch(unsigned one, unsigned other) { stand->bench.touch(one, other); }
EXPORT(set_wiring) void exported_set_wiring(unsigned pot, unsigned wiring) {
  stand->bench.set_wiring(pot, static_cast<arm::Wiring>(wiring));
}
EXPORT(let_float) void exported_let_float(unsigned pot, unsigned floats) { stand->bench.let_float(pot, floats != 0); }
EXPORT(wire_motor) void exported_wire_motor(unsigned joint, double gain, unsigned driver) {
  stand->bench.wire_motor(joint, gain, driver);
}
EXPORT(change_supply) void exported_change_supply(double volts) { stand->bench.change_supply(volts); }
EXPORT(share_supply) void exported_share_supply() { stand->bench.share_supply(); }
EXPORT(load_tip) void exported_load_tip(double mass) { stand->own.load_tip(mass); }
EXPORT(scale_play) void exported_scale_play(double times) { stand->own.scale_play(times); }
EXPORT(scale_noise) void exported_scale_noise(double times) { stand->bench.scale_noise(times); }
EXPORT(mend) void exported_mend() { stand->bench.mend(); }

// Numbers become: leader and follower (4 each, rad), voltages at the motors (4, V).
EXPORT(look) void exported_look() {
  std::size_t at = 0;
  for (const Four& four : {stand->person.angles(), stand->bench.angles(), stand->bench.voltages()})
    for (const double value : four) numbers[at++] = value;
}

// Two benches that behaved alike to the cycle have the same: interrupts, bytes, memory that was written, resets.
EXPORT(trace_hash) double exported_trace_hash() {
  return static_cast<double>(stand->board.trace_hash() >> 11);  // what a double holds
}

}  // extern "C"

}  // namespace greywhale::bench
