// Shares windows out between lanes and threads: see windows.h.
#include "windows/windows.h"

#include <algorithm>

#include "instructions.h"
#include "share_out.h"

namespace greywhale::windows {

namespace {

const Kernel& widest() {
#ifdef GREYWHALE_X86
  if (has_avx512()) return avx512::kKernel;
  if (has_avx2()) return avx2::kKernel;
#endif
  return baseline::kKernel;
}

}  // namespace

void simulate(const Windows& windows, const std::vector<Task>& tasks, int threads) {
  const Kernel& kernel = widest();
  const std::size_t count = tasks.size(), lanes = kernel.lanes;
  share_out((count + lanes - 1) / lanes, threads, [&](std::size_t group) {
    kernel.simulate(windows, &tasks[group * lanes], std::min(lanes, count - group * lanes));
  });
}

}  // namespace greywhale::windows
