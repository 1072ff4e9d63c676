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

// Faults of a potentiometer. Dead zone: its shaft is half a turn farther in its coupling, so that the dead zone, where
// the wiper touches nothing, comes first. Crossed: the wiper is on the supply and an end of the track on the input,
// where only the pull-down's current makes a difference.
enum class PotFault : std::uint8_t { none, frozen, slipping, loose, noisy, humming, reversed, dead_zone, crossed };

class PotFaults {
 public:
  void inject(std::size_t pot, PotFault fault) { pots_.at(pot) = {fault}; }
  void swap(std::size_t one, std::size_t other) { std::swap(order_.at(one), order_.at(other)); }
  void touch(std::size_t one, std::size_t other) { touching_ = {one, other}; }
  bool any() const {
    const auto is_faulty = [](const Pot& pot) { return pot.fault != PotFault::none; };
    return touching_ || order_ != kRightly || std::any_of(pots_.begin(), pots_.end(), is_faulty);
  }

  // Changes the voltages, once a slice. Where nothing is wrong, time does not count.
  void apply(Millivolts& millivolts) {
    if (!any()) return;
    ++slice_;
    for (std::size_t pot = 0; pot < kPots; ++pot) {
      if (pots_[pot].fault == PotFault::none) continue;
      millivolts[pot] = std::clamp(shown(pots_[pot], millivolts[pot], pot), 0.0, kSupply);
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

  struct Pot {
    PotFault fault = PotFault::none;
    double had = -1.0, showed = -1.0;  // mV last time, of the shaft and on the wire; below 0 before the first
  };

  double shown(Pot& pot, double truth, std::size_t number) const {
    switch (pot.fault) {
      case PotFault::none: break;
      case PotFault::frozen:
        if (pot.showed < 0.0) pot.showed = truth;
        return pot.showed;
      case PotFault::slipping: return slipped(pot, truth);
      case PotFault::loose: return slice_ % kLooseEvery < kLooseFor ? 0.0 : truth;
      case PotFault::noisy: return truth + kNoisy * Noise(1, number).gaussian(slice_);
      case PotFault::humming: return truth + kHum * sine(kHumTurn * (slice_ % kHumSlices));
      case PotFault::reversed: return kSupply - truth;
      case PotFault::dead_zone: {
        const double turn = std::fmod(kTrackShare * truth / kSupply + 0.5, 1.0);
        return turn <= kTrackShare ? kSupply * turn / kTrackShare : 0.0;
      }
      case PotFault::crossed: return kSupply * kPullDown / (kPullDown + 1.0 - truth / kSupply);
    }
    return truth;
  }

  static double slipped(Pot& pot, double truth) {
    if (pot.had < 0.0) pot.had = pot.showed = truth;
    const double way = truth - pot.had;
    if (std::fabs(way) >= kStill) pot.had = truth;
    else return std::clamp(pot.showed + way, 0.0, kSupply);
    pot.showed = std::clamp(pot.showed + (way > 0.0 ? way * (1.0 - kSlips) : way), 0.0, kSupply);
    return pot.showed;
  }

  std::array<Pot, kPots> pots_{};
  std::array<std::size_t, kPots> order_ = kRightly;
  std::optional<std::pair<std::size_t, std::size_t>> touching_;
  std::uint32_t slice_ = 0;
};

}  // namespace greywhale::arm
