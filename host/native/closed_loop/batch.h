// Many candidates at a time: sixteen lanes of a vector, and a thread for each core.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "experiment.h"

namespace greywhale::loop {

// One row each for every candidate, or a single one for all.
struct Batch {
  const Controllers* controllers;
  std::size_t controller_count;
  const PlantRow* plants;
  std::size_t plant_count;
  std::size_t count;
};

struct How {
  int substeps;              // exact: steps of the arm in a slice; else: steps of the arm in a tick, 1, 2 or 4
  int threads;               // 0: as many as there are cores
  bool exact;                // in the bench's double precision, one by one
  std::string instructions;  // one of instruction_sets(), or empty for the best; results are the same bits with all
};

// count x 4, count x 4, count x 4, count; then count x rows x 4, unused when `every` is 0.
struct Outputs {
  double* mse;
  double* itae;
  double* itau;
  bool* diverged;
  std::size_t every, rows;
  float* angles;
  std::int16_t* duties;
};

// What Experiment::noise points to, from its pots, seed and ticks: the numbers that an exact run draws itself, drawn
// once for all batches. Empty for quiet pots. Throws std::invalid_argument for an unknown instruction set, as run_batch
// does.
std::vector<float> noise_of(const Experiment& experiment, const std::string& instructions);

// The result does not depend on the number of threads.
void run_batch(const Experiment& experiment, const Batch& batch, const How& how, const Outputs& outputs);

// The vector form of the law, for tests.
struct LawCheck;
void check_law(const std::string& instructions, const LawCheck& check);

std::vector<std::string> instruction_sets();

}  // namespace greywhale::loop
