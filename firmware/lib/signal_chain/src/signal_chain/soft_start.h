// The share of the motor supply that the controllers may use: after a start it grows by the same step each tick.
#pragma once
#include <stdint.h>

namespace signal_chain {

class SoftStart {
 public:
  // From 0 to all of the supply in this many ticks, at least 1. Divides: not for the tick.
  void start(uint16_t ticks) {
    step_ = full / ticks;
    left_ = ticks;
    share_ = 0;
  }
  // To the share of the next tick; true with the last one.
  bool advance() {
    share_ += step_;
    if (--left_ != 0) return false;
    share_ = full;
    return true;
  }
  bool ended() const { return left_ == 0; }  // all of the supply
  void stop() { share_ = 0; }
  // 32768 is all of the supply.
  uint16_t share_q15() const { return static_cast<uint16_t>(share_ >> 16); }

 private:
  static constexpr uint32_t full = UINT32_C(1) << 31;

  uint32_t share_ = 0, step_ = 0;
  uint16_t left_ = 0;  // ticks
};

}  // namespace signal_chain
