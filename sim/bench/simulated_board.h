// The simulated Arduino as a bench sees it.
#pragma once

#include <string>

#include "board/board.h"
#include "seams.h"

namespace greywhale::bench {

class SimulatedBoard : public BoardSeam {
 public:
  // Watches the drivers' pins from now on.
  SimulatedBoard(board::Board& board, const Wiring& wiring) : board_(board) {
    watch(wiring.enable);
    watch_all(wiring.motors);
    if (wiring.second) watch_all(*wiring.second);
  }

  std::uint64_t cycle() override { return board_.cycle(); }
  void read_pins(Pins& pins) override { board_.read_outputs(pins.data()); }
  void hold_low(Pin pin) override { board_.hold_pin(std::string(1, pin.port), pin.bit, false); }
  void let_go(Pin pin) override { board_.let_pin_go(std::string(1, pin.port), pin.bit); }
  void set_millivolts(const arm::Millivolts& millivolts) override { board_.adc().set_millivolts(millivolts); }
  void set_floating(unsigned inputs) override { board_.adc().set_floating(static_cast<std::uint8_t>(inputs)); }
  void set_joined(unsigned inputs, unsigned wipers) override {
    board_.adc().set_joined(static_cast<std::uint8_t>(inputs), wipers);
  }
  void set_supply(unsigned millivolts) override { board_.set_supply(millivolts, kSeed); }
  bool run_until(std::uint64_t cycle) override { return board_.run_until(cycle) != board::RunState::crashed; }

 private:
  static constexpr std::uint64_t kSeed = 1;  // of what is in the memory when the supply comes back

  void watch(Pin pin) { board_.add_pin_output(std::string(1, pin.port), pin.bit); }
  void watch_all(const std::array<MotorWires, arm::kJoints>& motors) {
    for (const MotorWires& motor : motors) board_.add_duty_output(motor.pwm.timer, std::string(1, motor.pwm.channel));
    for (const MotorWires& motor : motors) watch(motor.direction);
  }

  board::Board& board_;
};

}  // namespace greywhale::bench
