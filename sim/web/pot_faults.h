// Mistakes between the potentiometers and the converter inside a page. The same as greywhale_sim.pot_faults, but for
// the numbers of the noise; tests/oracles proves it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "arm/random.h"
#include "board.h"

namespace greywhale::web {

enum class PotFault : std::uint8_t { none, frozen, slipping, loose, noisy, humming, reversed, turned, crossed };
constexpr unsigned kPotFaults = 9;

class PotFaults {
 public:
  void inject(std::size_t pot, PotFault kind) { liars_.at(pot) = {kind}; }
  void swap(std::size_t one, std::size_t other) { std::swap(order_.at(one), order_.at(other)); }
  void touch(std::size_t one, std::size_t other) { touching_ = {one, other}; }

  // Changes the voltages, once a slice. Where nothing is wrong, time does not count.
  void apply(Millivolts& millivolts) {
    if (!any()) return;
    ++slice_;
    for (std::size_t pot = 0; pot < kPots; ++pot) {
      if (liars_[pot].kind == PotFault::none) continue;
      millivolts[pot] = std::clamp(shown(liars_[pot], millivolts[pot], pot), 0.0, kSupply);
    }
    if (touching_) {
      double& one = millivolts[touching_->first];
      double& other = millivolts[touching_->second];
      one = other = (one + other) / 2.0;
    }
    const Millivolts before = millivolts;
    for (std::size_t pot = 0; pot < kPots; ++pot) millivolts[pot] = before[order_[pot]];
  }

 private:
  static constexpr double kSupply = 5000.0, kStill = 30.0, kNoisy = 100.0, kHum = 25.0;  // mV
  static constexpr double kSlips = 0.3, kPullDown = 10.0, kTrackShare = 300.0 / 360.0;
  static constexpr unsigned kLooseEvery = 920, kLooseFor = 8;             // slices
  static constexpr double kHumTurns = 6.283185307179586 * 50.0 * 250e-6;  // rad a slice

  static constexpr std::array<std::size_t, kPots> kRightly{0, 1, 2, 3, 4, 5, 6, 7};

  struct Liar {
    PotFault kind = PotFault::none;
    double had = -1.0, showed = -1.0;
  };

  bool any() const {
    const auto lies = [](const Liar& one) { return one.kind != PotFault::none; };
    return touching_ || order_ != kRightly || std::any_of(liars_.begin(), liars_.end(), lies);
  }

  double shown(Liar& liar, double truth, std::size_t pot) const {
    switch (liar.kind) {
      case PotFault::none: break;
      case PotFault::frozen:
        if (liar.showed < 0.0) liar.showed = truth;
        return liar.showed;
      case PotFault::slipping: return slipped(liar, truth);
      case PotFault::loose: return slice_ % kLooseEvery < kLooseFor ? 0.0 : truth;
      case PotFault::noisy: return truth + kNoisy * arm::Noise(1, pot).gaussian(slice_);
      case PotFault::humming: return truth + kHum * std::sin(kHumTurns * slice_);
      case PotFault::reversed: return kSupply - truth;
      case PotFault::turned: {
        const double turn = std::fmod(kTrackShare * truth / kSupply + 0.5, 1.0);
        return turn <= kTrackShare ? kSupply * turn / kTrackShare : 0.0;
      }
      case PotFault::crossed: return kSupply * kPullDown / (kPullDown + 1.0 - truth / kSupply);
    }
    return truth;
  }

  static double slipped(Liar& liar, double truth) {
    if (liar.had < 0.0) liar.had = liar.showed = truth;
    const double way = truth - liar.had;
    if (std::fabs(way) >= kStill) liar.had = truth;
    else return std::clamp(liar.showed + way, 0.0, kSupply);
    liar.showed = std::clamp(liar.showed + (way > 0.0 ? way * (1.0 - kSlips) : way), 0.0, kSupply);
    return liar.showed;
  }

  std::array<Liar, kPots> liars_{};
  std::array<std::size_t, kPots> order_ = kRightly;
  std::optional<std::pair<std::size_t, std::size_t>> touching_;
  std::uint32_t slice_ = 0;
};

}  // namespace greywhale::web
