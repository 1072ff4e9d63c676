// Shares a batch out between threads: see closed_loop/batch.h.
#include "closed_loop/batch.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>

namespace greywhale::loop {

namespace {

// Calls work(0) .. work(pieces - 1), each once, from `threads` threads.
template <class Work>
void share_out(std::size_t pieces, int threads, const Work& work) {
  const std::size_t cores = threads > 0 ? static_cast<std::size_t>(threads) : std::max(1u, std::thread::hardware_concurrency());
  std::atomic<std::size_t> next{0};
  const auto loop = [&] {
    for (std::size_t piece = next++; piece < pieces; piece = next++) work(piece);
  };
  std::vector<std::thread> helpers;
  for (std::size_t n = 1; n < std::min(cores, pieces); ++n) helpers.emplace_back(loop);
  loop();
  for (std::thread& helper : helpers) helper.join();
}

void store(const Measures& m, std::size_t n, const Outputs& out) {
  std::copy_n(m.mse, kJoints, out.mse + n * kJoints);
  std::copy_n(m.itae, kJoints, out.itae + n * kJoints);
  std::copy_n(m.itau, kJoints, out.itau + n * kJoints);
  out.diverged[n] = m.diverged;
}

Trace trace_of(std::size_t n, const Outputs& out) {
  if (out.every == 0) return {0, nullptr, nullptr};
  const std::size_t offset = n * out.rows * kJoints;
  return {out.every, out.angles + offset, out.duties + offset};
}

}  // namespace

void run_batch(const Experiment& x, const Batch& batch, const How& how, const Outputs& out) {
  const auto controllers_of = [&](std::size_t n) -> const Controllers& { return batch.controllers[batch.controller_count == 1 ? 0 : n]; };
  const auto plant_of = [&](std::size_t n) -> const PlantRow& { return batch.plants[batch.plant_count == 1 ? 0 : n]; };
  share_out(batch.count, how.threads, [&](std::size_t n) {
    store(run_single(x, controllers_of(n), plant_of(n), how.substeps, trace_of(n, out)), n, out);
  });
}

std::vector<std::string> instruction_sets() { return {"baseline"}; }

}  // namespace greywhale::loop
