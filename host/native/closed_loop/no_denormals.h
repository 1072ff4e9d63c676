// Arithmetic without denormal numbers, while an object of this class lives.
#pragma once

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace greywhale::loop::GREYWHALE_INSTRUCTIONS {

// Numbers too small to matter are 0, as they slow a processor down. They are 0 on every processor that can do it, or
// else a joint that all but rests would slide on one and stick on another. x86 and ARM differ in one case only, some
// 1e-7 of the numbers around 1e-38: a result below the smallest normal number that rounds up to it is kept by x86 and
// is 0 on ARM.
class NoDenormals {
 public:
  NoDenormals() : before_(control()) { set_control(before_ | kFlush); }
  ~NoDenormals() { set_control(before_); }
  NoDenormals(const NoDenormals&) = delete;
  NoDenormals& operator=(const NoDenormals&) = delete;

 private:
#if defined(__SSE__)
  using Register = unsigned;
  static constexpr Register kFlush = 0x8040;  // MXCSR: results (FZ) and operands (DAZ)
  static Register control() { return _mm_getcsr(); }
  static void set_control(Register value) { _mm_setcsr(value); }
#elif defined(__aarch64__)
  using Register = unsigned long long;
  static constexpr Register kFlush = 1u << 24;  // FPCR: FZ, results and operands
  static Register control() {
    Register value;
    __asm__ volatile("mrs %0, fpcr" : "=r"(value));
    return value;
  }
  static void set_control(Register value) { __asm__ volatile("msr fpcr, %0" : : "r"(value) : "memory"); }
#else
  using Register = unsigned;
  static constexpr Register kFlush = 0;
  static Register control() { return 0; }
  static void set_control(Register) {}
#endif
  Register before_;
};

}  // namespace greywhale::loop::GREYWHALE_INSTRUCTIONS
