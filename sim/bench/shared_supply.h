// A board on the motors' own supply, without a large capacitor: when a motor draws, it sinks and the chip stops.
#pragma once

#include <algorithm>
#include <cmath>

#include "seams.h"

namespace greywhale::bench {

class SharedSupply {
 public:
  static constexpr unsigned kFull = 5000,
                            kSunk = 2400;  // mV; below 2700 the brown-out detector holds the chip in reset

  explicit SharedSupply(BoardSeam& board) : board_(board) {}

  // Looks at the motors, once a slice.
  void look(const Four& voltages) {
    if (left_) {
      if (--left_ == 0) board_.set_supply(kFull);
    } else if (std::any_of(voltages.begin(), voltages.end(), [](double volts) { return std::fabs(volts) > kEnough; })) {
      left_ = kSunkSlices;
      board_.set_supply(kSunk);
    }
  }

  // Gives the board its own supply again.
  void mend() {
    if (left_) board_.set_supply(kFull);
    left_ = 0;
  }

 private:
  static constexpr double kEnough = 1.0;        // V at a motor: its current pulls the supply down
  static constexpr unsigned kSunkSlices = 120;  // 30 ms, until the regulator is back

  BoardSeam& board_;
  unsigned left_ = 0;
};

}  // namespace greywhale::bench
