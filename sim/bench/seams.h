// What a bench stands on: a board with pins and time, and an arm that moves. Each may be ours or somebody else's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "arm/parameters.h"
#include "arm/potentiometer.h"

namespace greywhale::bench {

using Four = std::array<double, arm::kJoints>;

constexpr std::uint64_t kClockHz = 16'000'000;
constexpr std::uint64_t kSliceCycles = 4000;
constexpr double kSlice = static_cast<double>(kSliceCycles) / kClockHz;  // s

struct Pin {
  char port;
  unsigned bit;
};

struct Pwm {
  unsigned timer;
  char channel;
};

struct MotorWires {
  Pwm pwm;
  Pin direction;
};

// The wires of an arm on a board. `enable` is the drivers', high for motors that have power; buttons close to ground.
struct Wiring {
  Pin enable;
  std::array<MotorWires, arm::kJoints> motors;
  std::optional<std::array<MotorWires, arm::kJoints>> second;  // for drivers with two inputs of a kind
  Pin estop, clutch;
};

// Outputs in the order in which a bench watches them: enable, duties 0..1, directions, and the second of each.
constexpr std::size_t kFewestPins = 1 + 2 * arm::kJoints, kMostPins = 1 + 4 * arm::kJoints;
using Pins = std::array<double, kMostPins>;

class BoardSeam {
 public:
  virtual ~BoardSeam() = default;
  virtual std::uint64_t cycle() = 0;
  virtual void read_pins(Pins& pins) = 0;
  virtual void hold_low(Pin pin) = 0;
  virtual void let_go(Pin pin) = 0;
  virtual void set_millivolts(const arm::Millivolts& millivolts) = 0;
  virtual void set_floating(unsigned inputs) = 0;                 // bits of inputs without a wire
  virtual void set_joined(unsigned inputs, unsigned wipers) = 0;  // bits of inputs on one wire, with so many wipers
  virtual void set_supply(unsigned millivolts) = 0;
  virtual bool run_until(std::uint64_t cycle) = 0;  // false where the program has crashed
};

class Plant {
 public:
  virtual ~Plant() = default;
  // Holds the voltages (V) for dt (s); angles (rad) then.
  virtual void step(const Four& volts, double dt, Four& angles) = 0;
  // At rest at these angles (rad), which it may change to where no stop is passed; false for a plant that nobody holds.
  virtual bool place(Four& angles) = 0;
  virtual Four motor_velocities() = 0;  // rad/s, at the output shaft
};

}  // namespace greywhale::bench
