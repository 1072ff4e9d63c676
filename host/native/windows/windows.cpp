// Shares windows out between lanes and threads: see windows.h.
#include "windows/windows.h"

#include <algorithm>

#include "instructions.h"
#include "share_out.h"

namespace greywhale::windows {

namespace {

const Kernel& widest() {
#ifdef GREYWHALE_X86
  if (has_avx2()) return avx2::kKernel;
#endif
  return baseline::kKernel;
}

// Runs of at most `most` tasks that can share a kernel call: those of one window, or of windows with the same times
// between rows.
std::vector<std::size_t> grouped(const std::vector<Task>& tasks, const Windows& w, std::size_t most) {
  const auto spacing = [&](std::size_t task) { return w.spacing + w.first[tasks[task].window]; };
  std::vector<std::size_t> begins;
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    const std::size_t begin = begins.empty() ? 0 : begins.back();
    const bool fits = !begins.empty() && task - begin < most &&
                      (tasks[task].window == tasks[begin].window ||
                       std::equal(spacing(begin), spacing(begin) + w.rows, spacing(task)));
    if (!fits) begins.push_back(task);
  }
  begins.push_back(tasks.size());
  return begins;
}

}  // namespace

void simulate(const Windows& windows, const std::vector<Task>& tasks, int threads) {
  if (tasks.empty()) return;
  const Kernel& kernel = widest();
  const std::vector<std::size_t> begins = grouped(tasks, windows, kernel.lanes);
  share_out(begins.size() - 1, threads, [&](std::size_t group) {
    kernel.simulate(windows, &tasks[begins[group]], begins[group + 1] - begins[group]);
  });
}

}  // namespace greywhale::windows
