// What must hold: a sentence for whoever reads the report, and an end that a fuzzer notices.
#pragma once
#include <cstdio>
#include <cstdlib>

namespace attack {

inline void must(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "VIOLATION: %s\n", what);
  std::abort();
}

}  // namespace attack
