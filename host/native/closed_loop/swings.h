// How often and how far a recorded signal swings to and fro: what tells a limit cycle from rest, from creep and from
// one overshoot; and how large its ripple is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace greywhale::loop {

struct Swings {
  std::int32_t reversals;  // turning points between legs that are both longer than the band
  double travel;  // the lengths of the legs between two reversals, summed: the first leg and the last do not count
};

// One signal on its way. A leg ends where the signal has come back from its extreme by more than the band.
class Legs {
 public:
  Legs(double first, double band) : band_(band), high_(first), low_(first), turned_(first) {}

  void pass(double value) {
    if (value > high_) high_ = value;
    if (value < low_) low_ = value;
    const bool down = direction_ >= 0 && value < high_ - band_;
    const bool up = !down && direction_ <= 0 && value > low_ + band_;
    if (!down && !up) return;
    if (direction_ != 0) {
      const double extreme = down ? high_ : low_;
      if (found_.reversals > 0) found_.travel += down ? extreme - turned_ : turned_ - extreme;
      ++found_.reversals;
      turned_ = extreme;
    }
    direction_ = down ? -1 : 1;
    high_ = low_ = value;
  }

  // Passes values between `least` and `most` at once; false where one of them may end a leg.
  bool pass_all(double least, double most) {
    const double high = most > high_ ? most : high_, low = least < low_ ? least : low_;
    if (direction_ >= 0 && !(least >= high - band_)) return false;
    if (direction_ <= 0 && !(most <= low + band_)) return false;
    high_ = high;
    low_ = low;
    return true;
  }

  Swings found() const { return found_; }

 private:
  double band_, high_, low_, turned_;
  int direction_ = 0;
  Swings found_{0, 0.0};
};

// Of `kSignals` signals side by side, `rows` values each. Most stretches end no leg, and pass at once.
template <std::size_t kSignals, class T>
void swings_of(const T* signals, std::size_t rows, double band, Swings* found) {
  constexpr std::size_t kStretch = 16;
  std::vector<Legs> legs;
  for (std::size_t i = 0; i < kSignals; ++i) legs.emplace_back(rows ? static_cast<double>(signals[i]) : 0.0, band);
  for (std::size_t first = 1; first < rows; first += kStretch) {
    const std::size_t last = std::min(rows, first + kStretch);
    T least[kSignals], most[kSignals];
    std::copy_n(signals + first * kSignals, kSignals, least);
    std::copy_n(least, kSignals, most);
    for (const T* row = signals + first * kSignals; row != signals + last * kSignals; row += kSignals) {
      for (std::size_t i = 0; i < kSignals; ++i) {
        least[i] = row[i] < least[i] ? row[i] : least[i];
        most[i] = row[i] > most[i] ? row[i] : most[i];
      }
    }
    for (std::size_t i = 0; i < kSignals; ++i) {
      if (legs[i].pass_all(static_cast<double>(least[i]), static_cast<double>(most[i]))) continue;
      for (std::size_t row = first; row < last; ++row) legs[i].pass(static_cast<double>(signals[row * kSignals + i]));
    }
  }
  for (std::size_t i = 0; i < kSignals; ++i) found[i] = legs[i].found();
}

// Mean square of a signal of integers less its own mean over `window` values around each (an odd number, at most
// `rows`), where all of those are there.
inline double ripple_of(const std::int16_t* signal, std::size_t rows, std::size_t stride, std::size_t window) {
  const auto size = static_cast<std::int64_t>(window);
  std::int64_t sum = 0;
  double squares = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    sum += signal[row * stride];
    if (row + 1 < window) continue;
    const auto less = static_cast<double>(size * signal[(row - window / 2) * stride] - sum);
    squares += less * less;
    sum -= signal[(row + 1 - window) * stride];
  }
  return squares / static_cast<double>(size * size) / static_cast<double>(rows - window + 1);
}

}  // namespace greywhale::loop
