// Which instruction sets this processor has, of those that core.cmake builds kernels for.
#pragma once

namespace greywhale {

#ifdef GREYWHALE_X86
inline bool has_avx2() { return __builtin_cpu_supports("avx2") != 0; }

inline bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}
#endif

}  // namespace greywhale
