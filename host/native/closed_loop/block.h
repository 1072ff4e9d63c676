// What a kernel gets: up to sixteen candidates and the experiment as plain numbers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "experiment.h"

namespace greywhale::loop {

constexpr std::size_t kBlock = 16;

// Candidates of one block; a short block is filled up with copies of its last candidate, whose results nobody reads.
struct Block {
  const fuzzy_pdi::Coefficients* controllers[kBlock];  // four each
  const PlantRow* plants[kBlock];
  Trace traces[kBlock];
  std::size_t count;
  std::int32_t*
      waiting;  // scratch: the duties commanded and not acting yet, late ticks x 4 joints x 16 candidates, zero
};

// Converter counts of the follower's potentiometers: gain x (angle in 2^-30 turns) + offset, and the noise of every
// slice.
struct Pots {
  float gain[kJoints], offset[kJoints];
  float linearity[kJoints];  // counts
  const float* noise;        // (4 x ticks + 1) x 4, or null
};

// What all blocks share, worked out once.
struct Shared {
  Pots pots;
  std::int32_t turns[kJoints][kSlices + 1];  // how many of a pot's four conversions fall into each slice of a tick and
                                             // the next's first
  std::int32_t duty_scale[kJoints];
  const std::uint16_t* limit_mv;  // ticks: the voltage limit of the soft start
};

// The laws of sixteen joints side by side, for tests: inputs and outputs are n x 16.
struct LawCheck {
  const fuzzy_pdi::Coefficients* laws;  // sixteen
  std::size_t n;
  const std::int32_t* leader;
  const std::int32_t* follower;
  const std::uint16_t* limit_mv;  // n
  std::int32_t* millivolts;
};

// One instruction set's code. core.cmake says which of them a build has.
struct Kernel {
  void (*run_block)(const Experiment& experiment, const Shared& shared, const Block& block, int steps_per_tick,
                    Measures* measures);
  void (*check_law)(const LawCheck& check);
  void (*draw_noise)(const Experiment& experiment, std::size_t slices, float* noise);  // slices x 4
};
namespace baseline {
extern const Kernel kKernel;
}
namespace avx2 {
extern const Kernel kKernel;
}
namespace avx512 {
extern const Kernel kKernel;
}

}  // namespace greywhale::loop
