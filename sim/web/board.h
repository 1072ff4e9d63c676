// The firmware on its board inside a page, without bootloader: power, reset, and ticks in four slices of 250 us.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include <hal.h>

#include "arm/potentiometer.h"

namespace greywhale::web {

using arm::kPots;
using arm::Millivolts;

class Board {
 public:
  void power_on(hal::ResetCause cause);  // starts the firmware anew
  void power_off();
  bool powered() const { return powered_; }
  unsigned starts() const { return starts_; }

  // Lets 250 us pass with these voltages at the converter. A bit of `floating` marks an input without a wire: the
  // sampling capacitor keeps what the conversion before left on it. Two of `joined` are inputs whose wires touch.
  void run_slice(const Millivolts& millivolts, unsigned floating, unsigned joined);

  void send(std::uint8_t byte) { to_board_.push_back(byte); }
  // What the board has said since the last call of `clear`.
  std::vector<std::uint8_t>& said() { return said_; }

 private:
  void tick();
  void convert(const Millivolts& millivolts, unsigned floating);
  void probe(const Millivolts& millivolts, unsigned floating, unsigned joined);
  unsigned count() const;  // of the charge, as the converter says it
  void move_bytes();
  void work();

  bool powered_ = false;
  unsigned starts_ = 0;
  unsigned slice_ = 0;      // of the tick
  unsigned converted_ = 0;  // in this tick
  double charge_ = 0.0;     // mV on the sampling capacitor
  Millivolts before_{};     // in the last slice: the probe comes early in the tick
  std::deque<std::uint8_t> to_board_;
  std::vector<std::uint8_t> said_;
};

}  // namespace greywhale::web
