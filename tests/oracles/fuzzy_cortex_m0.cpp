// Runs the controller on a bare Cortex-M0: reads vectors.bin, writes results.bin through semihosting. See
// test_fuzzy_cortex_m0.py.
#include <stdint.h>
#include <stdio.h>
#include <unistd.h>

#include "fuzzy_pdi.h"
#include "inference.h"

using namespace fuzzy_pdi;

namespace {

FILE *in, *out;

template <typename T>
T take() {
  T value;
  if (fread(&value, sizeof value, 1, in) != 1) value = T();
  return value;
}

template <typename T>
void give(T value) {
  fwrite(&value, sizeof value, 1, out);
}

Settings take_settings() {
  Settings s;
  int16_t* const sets[] = {&s.ne_c, &s.ze_a, &s.ze_c, &s.pe_b, &s.nce_c, &s.zce_a, &s.zce_c, &s.pce_b};
  for (int16_t* set : sets) *set = take<int16_t>();
  s.kp = take<uint32_t>();
  s.kd = take<uint32_t>();
  s.ki = take<uint32_t>();
  s.ku_mv = take<uint16_t>();
  s.ce_ticks = take<uint8_t>();
  return s;
}

}  // namespace

extern "C" {  // of cortex_m0.ld and newlib
extern uint32_t data_start, data_end, data_image, bss_start, bss_end, stack_top;
void initialise_monitor_handles();
[[noreturn]] void start();
}

static int run() {
  in = fopen("vectors.bin", "rb");
  out = fopen("results.bin", "wb");
  if (!in || !out) return 1;
  for (uint16_t controllers = take<uint16_t>(); controllers; --controllers) {
    const Settings settings = take_settings();
    const uint8_t period_ms = take<uint8_t>();
    Coefficients c = {};
    give(static_cast<uint8_t>(compile(settings, period_ms, c)));
    State state;
    reset(c, state);
    for (uint16_t periods = take<uint16_t>(); periods; --periods) {
      const int16_t leader = take<int16_t>();
      const int16_t follower = take<int16_t>();
      const Output o = step(c, state, leader, follower, take<uint16_t>());
      give(o.u_fuzzy);
      give(o.volts_mv);
      give(static_cast<uint8_t>(o.saturated | o.no_rule << 1));
      give(state.integral);
      give(state.fraction);
    }
  }
  fclose(out);
  return 0;
}

void start() {
  const uint32_t* image = &data_image;
  for (uint32_t* word = &data_start; word != &data_end; ++word) *word = *image++;
  for (uint32_t* word = &bss_start; word != &bss_end; ++word) *word = 0;
  initialise_monitor_handles();
  _exit(run());
}

struct Vectors {
  uint32_t* stack;
  void (*reset)();
};
__attribute__((section(".vectors"), used)) const Vectors vectors = {&stack_top, start};
