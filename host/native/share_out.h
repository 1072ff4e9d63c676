// Work shared out between threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#ifndef __wasm__  // it has no threads
#include <thread>
#endif

namespace greywhale {

// Calls work(0) .. work(pieces - 1), each once, from `threads` threads (0: one per core), but no more than pieces.
template <class Work>
void share_out(std::size_t pieces, int threads, const Work& work) {
#ifdef __wasm__
  (void)threads;
  for (std::size_t piece = 0; piece < pieces; ++piece) work(piece);
#else
  const std::size_t cores =
      threads > 0 ? static_cast<std::size_t>(threads) : std::max(1u, std::thread::hardware_concurrency());
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t piece = next++; piece < pieces; piece = next++) work(piece);
  };
  std::vector<std::thread> helpers;
  for (std::size_t n = 1; n < std::min(cores, pieces); ++n) helpers.emplace_back(take);
  take();
  for (std::thread& helper : helpers) helper.join();
#endif
}

}  // namespace greywhale
