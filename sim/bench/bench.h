// The bench: board, arm, potentiometers, drivers, supply, wires and a person in lock step on one simulated clock, and
// what may go wrong with them.
//
// Time advances in slices of 250 us. In each slice the bench reads the driver pins, moves the arm under the voltages
// that they mean, puts all eight potentiometers on the converter's inputs and lets the processor run. Nothing here
// looks at the wall clock: the same bytes into the serial port at the same cycles give the same trace.
//
// Potentiometers are 0..3 leader, 4..7 follower. A bench is what its callers check their wishes for: numbers are in
// their ranges.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "arm/pot_faults.h"
#include "arm/potentiometer.h"
#include "drivers.h"
#include "own_arm.h"
#include "person.h"
#include "pins_seen.h"
#include "seams.h"
#include "shared_supply.h"

namespace greywhale::bench {

struct Electrics {
  Chip chip;
  double supply;    // V, of the motors
  Four emf;         // V s of each motor at its output shaft; needed where a chip lets motors coast
  unsigned in_use;  // bits of joints; the others have no potentiometers and no motor
};

struct Pots {
  std::array<arm::Potentiometer, arm::kJoints> leader, follower;
  double leader_supply, follower_supply;  // V
};

class Bench {
 public:
  // Called after every slice: cycle reached, pins at its beginning.
  using Trace = std::function<void(std::uint64_t cycle, const Pins& pins)>;

  // `own` is the plant where it is the bench's own arm, and else null.
  Bench(BoardSeam& board, const Wiring& wiring, Person& person, Plant& plant, OwnArm* own, const Pots& pots,
        std::uint64_t seed, const Electrics& electrics);
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  // False where the program on the board crashed.
  bool run_slices(std::uint64_t count);
  void set_trace(Trace trace) { trace_ = std::move(trace); }

  // Holds the follower in a pose by hand, if its plant allows that.
  void place(const Four& pose);

  // What is wrong, or is done by hand. `mend` wires everything rightly again.
  void inject(std::size_t pot, arm::PotFault fault) { pot_faults_.inject(pot, fault); }
  void swap(std::size_t one, std::size_t other) { pot_faults_.swap(one, other); }
  void touch(std::size_t one, std::size_t other);
  void set_wiring(std::size_t pot, arm::Wiring wiring);
  void let_float(std::size_t pot, bool floats);  // its wire is off, and nothing pulls the input
  // Puts a motor on a driver, the right way (1), the wrong way (-1), a wire off (0), or weak (0.2).
  void wire_motor(std::size_t joint, double gain, std::size_t driver);
  void change_supply(double volts);
  void share_supply() { shared_supply_.emplace(board_); }  // between board and motors
  void mend();
  void scale_noise(double times);  // of the potentiometers, times their own
  void press_estop(bool pressed);
  void press_clutch(bool pressed);
  OwnArm* own_arm() { return own_; }

  Four& angles() { return angles_; }      // of the follower, rad
  Four& voltages() { return voltages_; }  // at the motors
  const arm::Millivolts& millivolts() const { return millivolts_; }
  const std::array<Bridge, arm::kJoints>& bridges() const { return bridges_; }
  const Pins& pins() const { return pins_; }  // at the beginning of the last slice
  std::size_t pin_count() const { return wiring_.second ? kMostPins : kFewestPins; }
  Person& person() { return person_; }
  PinsSeen take_pins_seen();
  bool estop_pressed() const { return estop_pressed_; }
  bool clutch_pressed() const { return clutch_pressed_; }
  double supply() const { return electrics_.supply; }
  unsigned floating() const { return floating_; }
  bool has_pot_faults() const { return pot_faults_.any(); }
  bool shares_supply() const { return shared_supply_.has_value(); }
  const Four& motor_gains() const { return gains_; }
  const std::array<std::size_t, arm::kJoints>& motor_drivers() const { return drivers_; }
  arm::Wiring pot_wiring(std::size_t pot) const { return bank(pot).wiring(pot % arm::kJoints); }

 private:
  void run_slice();
  void drive();
  void coast();
  void show_pots();
  void connect_all();
  void ground(Pin pin, bool closed);
  bool in_use(std::size_t joint) const { return electrics_.in_use >> joint & 1u; }
  arm::Potentiometers& bank(std::size_t pot) { return pot < arm::kJoints ? leader_pots_ : follower_pots_; }
  const arm::Potentiometers& bank(std::size_t pot) const { return pot < arm::kJoints ? leader_pots_ : follower_pots_; }

  BoardSeam& board_;
  Wiring wiring_;
  Person& person_;
  Plant& plant_;
  OwnArm* own_;
  Pots own_pots_;
  arm::Potentiometers leader_pots_, follower_pots_;
  Electrics electrics_;
  double own_supply_;
  arm::PotFaults pot_faults_;
  std::optional<SharedSupply> shared_supply_;
  PinsSeen seen_;
  Trace trace_;
  Four gains_{};
  std::array<std::size_t, arm::kJoints> drivers_{0, 1, 2, 3};  // which each motor is on
  std::array<Bridge, arm::kJoints> bridges_{};
  Pins pins_{};
  bool rewired_ = true;  // the voltages are to be worked out anew
  bool enabled_ = false, coasts_ = false;
  bool estop_pressed_ = false, clutch_pressed_ = false;
  unsigned floating_ = 0;  // bits of the inputs without a wire
  arm::Millivolts millivolts_{};
  Four voltages_{}, angles_;
};

}  // namespace greywhale::bench
