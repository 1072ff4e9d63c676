// The power of recorded angles in a band of frequencies, block by block: what tells rattling from following.
#pragma once

#include <cstddef>

namespace greywhale::loop {

// A filter of the second order, y = b0 x + b1 x' + b2 x'' - a1 y' - a2 y'', with a state for each of `kLanes` signals.
template <std::size_t kLanes>
struct Section {
  double b0, b1, b2, a1, a2;
  double first[kLanes] = {}, second[kLanes] = {};

  void pass(double (&x)[kLanes]) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double y = b0 * x[i] + first[i];
      first[i] = b1 * x[i] - a1 * y + second[i];
      second[i] = b2 * x[i] - a2 * y;
      x[i] = y;
    }
  }
};

// The mean square of what two sections let pass, `kLanes` values for each block of `length` rows that lie `stride` rows
// apart. The filter starts at rest at the first row.
template <std::size_t kLanes, class T>
void band_power(const T* rows, std::size_t stride, std::size_t blocks, std::size_t length, Section<kLanes> low,
                Section<kLanes> high, double* power) {
  const T* row = rows;
  for (std::size_t block = 0; block < blocks; ++block) {
    double sum[kLanes] = {};
    for (std::size_t k = 0; k < length; ++k, row += stride * kLanes) {
      double x[kLanes];
      for (std::size_t i = 0; i < kLanes; ++i) x[i] = static_cast<double>(row[i]) - static_cast<double>(rows[i]);
      low.pass(x);
      high.pass(x);
      for (std::size_t i = 0; i < kLanes; ++i) sum[i] += x[i] * x[i];
    }
    for (std::size_t i = 0; i < kLanes; ++i) power[block * kLanes + i] = sum[i] / static_cast<double>(length);
  }
}

}  // namespace greywhale::loop
