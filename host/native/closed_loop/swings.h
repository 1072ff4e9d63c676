// How often and how far a recorded signal swings to and fro: what tells a limit cycle from rest, from creep and from
// one overshoot; and how large its ripple is.
#pragma once

#include <cstddef>
#include <cstdint>

namespace greywhale::loop {

struct Swings {
  std::int32_t reversals;  // turning points between legs that are both longer than the band
  double travel;  // the lengths of the legs between two reversals, summed: the first leg and the last do not count
};

// Of `rows` values, `stride` apart. A leg ends where the signal has come back from its extreme by more than the band.
template <class T>
Swings swings_of(const T* signal, std::size_t rows, std::size_t stride, double band) {
  Swings found{0, 0.0};
  if (rows == 0) return found;
  double high = static_cast<double>(signal[0]), low = high, turned = high;
  int direction = 0;
  for (std::size_t row = 1; row < rows; ++row) {
    const double value = static_cast<double>(signal[row * stride]);
    if (value > high) high = value;
    if (value < low) low = value;
    const bool down = direction >= 0 && value < high - band;
    const bool up = !down && direction <= 0 && value > low + band;
    if (!down && !up) continue;
    if (direction != 0) {
      const double extreme = down ? high : low;
      if (found.reversals > 0) found.travel += down ? extreme - turned : turned - extreme;
      ++found.reversals;
      turned = extreme;
    }
    direction = down ? -1 : 1;
    high = low = value;
  }
  return found;
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
