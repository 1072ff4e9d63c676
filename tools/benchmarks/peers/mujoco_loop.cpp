// The closed loop of four joints in MuJoCo's C API: 1 ms steps, the firmware's fuzzy law natively, rigid gears, 10-bit
// sensors. Usage: mujoco_loop MODEL.xml SECONDS; prints wall-clock seconds.
#include <mujoco/mujoco.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "fuzzy_pdi.h"

namespace {

constexpr int kJoints = 4;

std::int16_t reading(double angle) {
  const double count = std::floor((angle / 5.235987755982989 + 0.5) * 1024.0);
  return static_cast<std::int16_t>(((static_cast<int>(count) * 16 - 8184) * 10734 + 4096) >> 13);
}

void run(const mjModel* model, int ticks) {
  const fuzzy_pdi::Settings settings = {-8192, -8192,  8192,  8192,   -8192, -8192, 8192,
                                        8192,  131072, 32768, 262144, 15000, 1};
  fuzzy_pdi::Coefficients law;
  if (fuzzy_pdi::compile(settings, 1, law) != fuzzy_pdi::Refusal::none) std::abort();
  fuzzy_pdi::State memory[kJoints];
  for (fuzzy_pdi::State& m : memory) fuzzy_pdi::reset(law, m);
  mjData* data = mj_makeData(model);
  for (int tick = 0; tick < ticks; ++tick) {
    for (int i = 0; i < kJoints; ++i) {
      const double leader = 0.5 * std::sin(2e-3 * tick * (1.0 + 0.3 * i));
      const fuzzy_pdi::Output out = fuzzy_pdi::step(law, memory[i], reading(leader), reading(data->qpos[i]), 15000);
      data->ctrl[i] = 1e-3 * out.volts_mv;
    }
    mj_step(model, data);
  }
  mj_deleteData(data);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) return 2;
  char error[1000] = "";
  mjModel* model = mj_loadXML(arguments[1], nullptr, error, sizeof error);
  if (model == nullptr) return std::fprintf(stderr, "%s\n", error), 1;
  model->opt.timestep = 1e-3;
  model->opt.integrator = mjINT_IMPLICITFAST;
  const int ticks = static_cast<int>(1000.0 * std::atof(arguments[2]));
  const auto start = std::chrono::steady_clock::now();
  run(model, ticks);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  std::printf("%.9f\n", taken.count());
  mj_deleteModel(model);
  return 0;
}
