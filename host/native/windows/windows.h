// Short windows of a log for candidate arms, as plain pointers: what the kernels of every instruction set take.
#pragma once

#include <cstddef>
#include <cstdint>

namespace greywhale::windows {

constexpr std::size_t kMostLanes = 4;

// The log on the integration's grid, and where its windows begin; rows of four joints where not said otherwise.
struct Windows {
  const std::int64_t* first;                   // row, one a window
  const double *angles, *velocities, *sides;   // of a window's start: links in rad and rad/s; place in the gap, -1..1
  const double* volts;                         // `substeps` rows for every row of the log
  const double* spacing;                       // s from a row to the next, one number a row
  std::size_t rows, substeps, every;
};

// One candidate in one window.
struct Lane {
  const double* plant;                         // a row of plants
  const double *offset, *kick;
  std::size_t window;
  double* out;                                 // (rows kept, 4)
};

// `count` lanes, at most as many as the kernel's name says, whose windows have the same spacing.
void simulate_2(const Windows& windows, const Lane* lanes, std::size_t count);
void simulate_4_avx2(const Windows& windows, const Lane* lanes, std::size_t count);

}  // namespace greywhale::windows
