// The bench inside a page: board, arm, potentiometers and a person's hands in lock step on one simulated clock, and
// what a person may do wrong with them. The same as greywhale_sim.bench with DRV8838 drivers; tests/oracles proves it.
#pragma once

#include <array>
#include <cstdint>

#include "arm/arm.h"
#include "arm/pot_faults.h"
#include "arm/potentiometer.h"
#include "bench_person.h"
#include "board.h"

namespace greywhale::web {

struct Parameters {
  arm::ArmParameters arm;
  std::array<arm::Potentiometer, arm::kJoints> leader_pots, follower_pots;
  double leader_pots_supply, follower_pots_supply;  // V
};

class Bench {
 public:
  explicit Bench(const Parameters& parameters, std::uint64_t seed);

  // Advances 250 us.
  void run_slice();

  Board board;
  BenchPerson person;
  arm::PotFaults pot_faults;
  void set_wiring(std::size_t pot, arm::Wiring wiring);
  void let_float(std::size_t pot, bool floats);
  void touch(unsigned one, unsigned other);
  void wire_motor(std::size_t joint, double gain, std::size_t driver);
  void change_supply(double volts) { supply_ = volts; }
  void share_supply() { shared_ = true; }  // the board lives on the motors' supply, which sinks when a motor draws
  void load_tip(double mass);              // kg; the arm is built anew where it is, at rest
  void scale_play(double times);           // of the gears, times their own; the arm is built anew as well
  void scale_noise(double times);          // of the potentiometers, times their own
  void mend();                             // wires everything rightly again

  // From now on the converter sees these voltages, and not the potentiometers'.
  void hold_inputs(const Millivolts& millivolts);

  const Millivolts& millivolts() const { return millivolts_; }
  const Four& voltages() const { return voltages_; }  // at the motors
  const Four& follower() const { return follower_; }  // rad

 private:
  void drive();
  void place(const Four& pose);
  void build_arm();
  void look_at_supply();

  Parameters parameters_;
  arm::Arm arm_;
  arm::Potentiometers leader_pots_, follower_pots_;
  Four gains_{1.0, 1.0, 1.0, 1.0};  // of the motors: -1 wrong way round, 0 off, 0.2 weak
  std::array<std::size_t, arm::kJoints> drivers_{0, 1, 2, 3};
  double supply_;
  double play_ = 1.0;  // times the gears' own
  bool shared_ = false;
  unsigned sunk_ = 0;      // slices until the shared supply is back
  unsigned floating_ = 0;  // bits of the inputs without a wire
  unsigned joined_ = 0;    // of those whose wires touch
  bool held_ = false;
  Millivolts millivolts_{};
  Four voltages_{}, follower_{};
};

}  // namespace greywhale::web
