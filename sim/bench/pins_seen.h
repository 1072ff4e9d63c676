// The most that the drivers' pins have asked for: tells if a motor was ever driven too hard, or for too long.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "seams.h"

namespace greywhale::bench {

class PinsSeen {
 public:
  // Notes the pins as they are from this cycle on.
  void look(std::uint64_t cycle, bool enabled, const Four& duties) {
    if (!enabled) {
      longest_ = longest(cycle);
      on_since_.reset();
      return;
    }
    if (!on_since_) on_since_ = cycle;
    for (std::size_t driver = 0; driver < duties.size(); ++driver)
      duties_[driver] = std::max(duties_[driver], duties[driver]);
  }

  const Four& duties() const { return duties_; }  // the highest of each driver while they were enabled
  // The most cycles that the drivers were enabled without a break, up to this cycle.
  std::uint64_t longest(std::uint64_t cycle) const { return std::max(longest_, on_since_ ? cycle - *on_since_ : 0); }

 private:
  Four duties_{};
  std::uint64_t longest_ = 0;
  std::optional<std::uint64_t> on_since_;
};

}  // namespace greywhale::bench
