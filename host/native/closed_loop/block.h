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
};

// Converter counts of the follower's potentiometers: gain x (angle in 2^-30 turns) + offset, and the noise of every slice.
struct Pots {
  float gain[kJoints], offset[kJoints];
  float linearity[kJoints];  // counts
  const float* noise;        // (4 x ticks + 1) x 4, or null
};

using Kernel = void (*)(const Experiment& experiment, const Pots& pots, const Block& block, int steps_per_tick, Measures* measures);

void run_block_avx512(const Experiment&, const Pots&, const Block&, int steps_per_tick, Measures*);
void run_block_avx2(const Experiment&, const Pots&, const Block&, int steps_per_tick, Measures*);
void run_block_baseline(const Experiment&, const Pots&, const Block&, int steps_per_tick, Measures*);

// The laws of sixteen joints side by side, for tests: inputs and outputs are n x 16.
struct LawCheck {
  const fuzzy_pdi::Coefficients* laws;  // sixteen
  std::size_t n;
  const std::int32_t* leader;
  const std::int32_t* follower;
  const std::uint16_t* limit_mv;  // n
  std::int32_t* millivolts;
};
void check_law_avx512(const LawCheck&);
void check_law_avx2(const LawCheck&);
void check_law_baseline(const LawCheck&);

}  // namespace greywhale::loop
