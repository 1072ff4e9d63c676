// Shares a batch out between threads and picks the kernel for this processor: see closed_loop/batch.h.
#include "closed_loop/batch.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "closed_loop/block.h"
#include "closed_loop/firmware_tick.h"
#include "instructions.h"
#include "share_out.h"

namespace greywhale::loop {

namespace {

struct InstructionSet {
  const char* name;
  bool (*available)();
  const Kernel* kernel;
};

// The best first.
constexpr InstructionSet kInstructionSets[] = {
#ifdef GREYWHALE_X86
    {"avx512", has_avx512, &avx512::kKernel},
    {"avx2", has_avx2, &avx2::kKernel},
#endif
    {"baseline", [] { return true; }, &baseline::kKernel},
};

const Kernel& chosen(const std::string& name) {
  for (const InstructionSet& set : kInstructionSets) {
    if ((name.empty() || name == set.name) && set.available()) return *set.kernel;
  }
  throw std::invalid_argument("the instruction set \"" + name + "\" is not known or not in this processor.");
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

Pots pots_of(const Experiment& x) {
  Pots pots{};
  const double full = x.pot_supply * 1000.0 * 1024.0 / kConverterMillivolts;  // counts
  for (std::size_t i = 0; i < kJoints; ++i) {
    const arm::Potentiometer& pot = x.pots[i];
    const double per_radian = full * pot.direction / pot.track;
    pots.gain[i] = static_cast<float>(per_radian * 6.283185307179586 / 1073741824.0);
    pots.offset[i] = static_cast<float>(0.5 * full - per_radian * pot.centre);
    pots.linearity[i] = static_cast<float>(full * pot.linearity);
  }
  pots.noise = x.noise;
  return pots;
}

// The limits of the soft start's ramp: the controllers run from tick 1 on.
std::vector<std::uint16_t> limits_of(const Experiment& x) {
  std::vector<std::uint16_t> limits(x.ticks);
  SoftStart ramp(x.settings.soft_start_ms);
  for (std::size_t tick = 1; tick < x.ticks; ++tick) limits[tick] = ramp.next_limit_mv(x.settings.supply_mv);
  return limits;
}

Shared shared_of(const Experiment& x, const std::vector<std::uint16_t>& limits) {
  Shared shared{};
  shared.pots = pots_of(x);
  for (std::size_t i = 0; i < kJoints; ++i) {
    for (std::size_t turn = 0; turn < kConversions; ++turn) ++shared.turns[i][slice_of(x.timing, turn, kFollower + i)];
    shared.duty_scale[i] = duty_scale(x.settings.pwm_top[i], x.settings.supply_mv);
  }
  shared.limit_mv = limits.data();
  return shared;
}

const Controllers& controllers_of(const Batch& batch, std::size_t n) {
  return batch.controllers[batch.controller_count == 1 ? 0 : n];
}
const PlantRow& plant_of(const Batch& batch, std::size_t n) { return batch.plants[batch.plant_count == 1 ? 0 : n]; }

void run_lanes(const Experiment& x, const Batch& batch, const How& how, const Outputs& out) {
  const Kernel& kernel = chosen(how.instructions);
  const std::vector<std::uint16_t> limits = limits_of(x);
  const Shared shared = shared_of(x, limits);
  share_out((batch.count + kBlock - 1) / kBlock, how.threads, [&](std::size_t piece) {
    const std::size_t first = piece * kBlock;
    std::vector<std::int32_t> waiting(static_cast<std::size_t>(x.timing.late) * kJoints * kBlock);
    Block block{};
    block.waiting = waiting.data();
    block.count = std::min(kBlock, batch.count - first);
    for (std::size_t n = 0; n < kBlock; ++n) {
      const std::size_t candidate = first + std::min(n, block.count - 1);
      block.controllers[n] = controllers_of(batch, candidate).data();
      block.plants[n] = &plant_of(batch, candidate);
      block.traces[n] = trace_of(candidate, out);
    }
    Measures measures[kBlock];
    kernel.run_block(x, shared, block, how.substeps, measures);
    for (std::size_t n = 0; n < block.count; ++n) store(measures[n], first + n, out);
  });
}

}  // namespace

std::vector<float> noise_of(const Experiment& x, const std::string& instructions) {
  const Kernel& kernel = chosen(instructions);
  const bool quiet =
      std::all_of(x.pots.begin(), x.pots.end(), [](const arm::Potentiometer& pot) { return pot.noise == 0.0; });
  if (quiet) return {};
  const std::size_t slices = kSlices * x.ticks + 1;
  std::vector<float> noise(slices * kJoints);
  kernel.draw_noise(x, slices, noise.data());
  return noise;
}

void run_batch(const Experiment& x, const Batch& batch, const How& how, const Outputs& out) {
  if (!how.exact) return run_lanes(x, batch, how, out);
  share_out(batch.count, how.threads, [&](std::size_t n) {
    store(run_exact(x, controllers_of(batch, n), plant_of(batch, n), how.substeps, trace_of(n, out)), n, out);
  });
}

void check_law(const std::string& instructions, const LawCheck& check) { chosen(instructions).check_law(check); }

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const InstructionSet& set : kInstructionSets) {
    if (set.available()) names.emplace_back(set.name);
  }
  return names;
}

}  // namespace greywhale::loop
