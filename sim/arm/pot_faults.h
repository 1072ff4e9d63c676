// Mistakes between the potentiometers of both arms and the converter: swapped wires, slipping shafts, loose contacts,
// noise.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "elementary.h"
#include "potentiometer.h"
#include "random.h"

namespace greywhale::arm {

// How a potentiometer lies. Turned: its shaft is half a turn farther in its coupling, so that the dead zone, where the
// wiper touches nothing, comes first. Crossed: the wiper is on the supply and an end of the track on the input, where
// only the pull-down's current makes a difference.
enum class PotFault : std::uint8_t { none, frozen, slipping, loose, noisy, humming, reversed, turned, crossed };

class PotFaults {
 public:
  void inject(std::size_t pot, PotFault kind) { liars_.at(pot) = {kind}; }
  void swap(std::size_t one, std::size_t other) { std::swap(order_.at(one), order_.at(other)); }
  void touch(std::size_t one, std::size_t other) { touching_ = {one, other}; }
  bool any() const {
    const auto lies = [](const Liar& one) { return one.kind != PotFault::none; };
    return touching_ || order_ != kRightly || std::any_of(liars_.begin(), liars_.end(), lies);
  }

  // Changes the voltages, once a slice. Where nothing is wrong, time does not count.
  void apply(Millivolts& millivolts) {
    if (!any()) return;
    ++slice_;
    for (std::size_t pot = 0; pot < kPots; ++pot) {
      if (liars_[pot].kind == PotFault::none) continue;
      millivolts[pot] = std::clamp(shown(liars_[pot], millivolts[pot], pot), 0.0, kSupply);
    }
    if (touching_) {
      double& one = millivolts.at(touching_->first);
      double& other = millivolts.at(touching_->second);
      one = other = (one + other) / 2.0;
    }
    const Millivolts before = millivolts;
    for (std::size_t pot = 0; pot < kPots; ++pot) millivolts[pot] = before[order_[pot]];
  }

 private:
  static constexpr double kSupply = 5000.0, kHum = 25.0;  // mV
  static constexpr double kNoisy = 100.0;                 // mV rms, of a wiper's wire along a motor's
  static constexpr double kStill = 30.0;                  // mV; less is noise, and no slipping shaft moves
  static constexpr double kSlips = 0.3;                 // of every way up, so that the same angle reads lower each time
  static constexpr double kPullDown = 10.0;             // how many times its resistance is the track's
  static constexpr double kTrackShare = 300.0 / 360.0;  // of a turn; the rest is the dead zone
  static constexpr unsigned kLooseEvery = 920, kLooseFor = 8;         // slices
  static constexpr unsigned kHumSlices = 80;                          // of 250 us: 50 Hz
  static constexpr double kHumTurn = 6.283185307179586 / kHumSlices;  // rad a slice

  static constexpr std::array<std::size_t, kPots> kRightly{0, 1, 2, 3, 4, 5, 6, 7};

  struct Liar {
    PotFault kind = PotFault::none;
    double had = -1.0, showed = -1.0;
  };

  double shown(Liar& liar, double truth, std::size_t pot) const {
    switch (liar.kind) {
      case PotFault::none: break;
      case PotFault::frozen:
        if (liar.showed < 0.0) liar.showed = truth;
        return liar.showed;
      case PotFault::slipping: return slipped(liar, truth);
      case PotFault::loose: return slice_ % kLooseEvery < kLooseFor ? 0.0 : truth;
      case PotFault::noisy: return truth + kNoisy * Noise(1, pot).gaussian(slice_);
      case PotFault::humming: return truth + kHum * sine(kHumTurn * (slice_ % kHumSlices));
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

}  // namespace greywhale::arm
