// Short windows of a log, each started from its own state and driven by the logged voltages, for many candidate arms at
// a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace greywhale::windows {

// The log on the integration's grid, and where its windows begin; rows of four joints where not said otherwise.
struct Windows {
  const std::int64_t* first;          // row, one a window
  const double *angles, *velocities;  // of a window's start, as the potentiometers show the links: rad, rad/s
  const double *sides, *places;       // where the motor then stands in its gap, and the joint in its
                                      // potentiometer's play, -1..1
  const double* volts;                // `substeps` rows for every row of the log
  const double* spacing;              // s from a row to the next, one number a row
  std::size_t rows, substeps, every;
  // How many rows before a window the log leads the links, and where these are in every row of the log, as above. With
  // none a motor stands where its side says, as fast as its link.
  const std::int64_t* led = nullptr;
  const double *log_angles = nullptr, *log_velocities = nullptr, *log_places = nullptr;
};

// One candidate in one window.
struct Task {
  const double* plant;  // a row of plants
  const double* offset;
  std::size_t window;
  double* out;  // (rows kept, 4)
};

// All of them, from `threads` threads (0: one per core), in as many lanes as the processor has; neither changes a bit
// of the result.
void simulate(const Windows& windows, const std::vector<Task>& tasks, int threads);

// One instruction set's code: it takes up to so many lanes.
struct Kernel {
  void (*simulate)(const Windows& windows, const Task* tasks, std::size_t count);
  std::size_t lanes;
};
namespace avx512 {
extern const Kernel kKernel;
}
namespace baseline {
extern const Kernel kKernel;
}
namespace avx2 {
extern const Kernel kKernel;
}

}  // namespace greywhale::windows
