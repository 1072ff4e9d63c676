// What may still be begun before the next tick. Nothing is cut short once it has begun, so each kind of work has a
// latest start within the tick.
#pragma once
#include <stdint.h>

namespace app {

class TickBudget {
 public:
  constexpr TickBudget() : link_served_(false), quiet_ticks_(0) {}

  // Once after each tick.
  void renew() {
    if (link_served_) quiet_ticks_ = 0;
    else if (quiet_ticks_ < quiet_enough) ++quiet_ticks_;
    link_served_ = false;
  }
  // Bytes of the link are being taken.
  void serve_link() { link_served_ = true; }

  // A step of applying a set: to compile a joint's controller takes most of a tick.
  static bool may_apply(uint16_t age_us) { return age_us <= 300; }
  // Samples, a byte for the EEPROM, more bytes of the link.
  static bool may_work(uint16_t age_us) { return age_us <= 800; }
  // The first bytes of the link in this tick go before other work, because a stop must get through. They may be taken
  // late. That may delay the next tick, so after bytes of the link none are taken late for some ticks.
  bool may_serve_link_first(uint16_t age_us) const {
    return !link_served_ && (may_work(age_us) || quiet_ticks_ == quiet_enough);
  }
  bool is_spent(uint16_t age_us) const { return !may_work(age_us) && !may_serve_link_first(age_us); }

 private:
  static constexpr uint8_t quiet_enough = 4;

  bool link_served_ : 1;     // in this tick
  uint8_t quiet_ticks_ : 7;  // since the last in which the link was served, at most quiet_enough
};

}  // namespace app
