// Steps eight random arms as one vector and one by one; exit code 0 when every bit of every state is the same.
#include "scalar.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

namespace greywhale::arm {

constexpr int kLanes = 8;
typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));
typedef long long Mask __attribute__((vector_size(kLanes * sizeof(long long))));

inline bool any(Mask mask) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (mask[lane] != 0) return true;
  }
  return false;
}
inline Mask either(Mask one, Mask other) { return one | other; }

}  // namespace greywhale::arm

#include "step.h"

using namespace greywhale::arm;

namespace {

std::mt19937_64 generator(1);
double between(double low, double high) { return low + (high - low) * std::generate_canonical<double, 53>(generator); }

Plant<double> random_arm(bool rigid, bool worn) {
  ArmParameters p{};
  for (Link& link : p.links)
    link = {between(0.1, 0.3), 0.1, 0.05, between(1e-4, 2e-4), between(1e-4, 2e-4), between(1e-4, 2e-4)};
  p.gravity = 9.81;
  p.tip_mass = between(0.0, 0.1);
  Plant<double> plant{rigid_body(p), {}};
  for (Joint<double>& joint : plant.joints) {
    const double strength = between(0.1, 1.0);
    joint.actuator = {strength, between(0.003, 0.03), between(0.1, 1.0), 2.0};
    joint.friction = {0.5 * strength, 0.7 * strength, 0.1, 0.0, 0.0};
    if (worn) joint.friction.load = between(0.0, 0.5), joint.friction.creep = between(0.0, 0.05);
    if (!rigid) joint.gear = {between(0.001, 0.006), between(50.0, 400.0), between(0.02, 0.5), between(0.0, 0.05)};
    joint.stops = {-1.0, 1.2};
  }
  return plant;
}

// A plant or a state is nothing but numbers, so lane and scalar differ in stride only.
template <class One, class Many>
void put(const One& one, Many& many, int lane) {
  static_assert(sizeof(Many) == kLanes * sizeof(One));
  const double* from = reinterpret_cast<const double*>(&one);
  double* to = reinterpret_cast<double*>(&many);
  for (std::size_t i = 0; i < sizeof(One) / sizeof(double); ++i)
    to[i * kLanes + static_cast<std::size_t>(lane)] = from[i];
}

// Whether lanes and single arms stay the same through a long run.
int compare(bool worn) {
  Plant<Lanes> plants{};
  State<Lanes> states{};
  Plant<double> single[kLanes];
  State<double> state[kLanes] = {};
  for (int lane = 0; lane < kLanes; ++lane) {
    single[lane] = random_arm(lane % 4 == 3, worn);
    put(single[lane], plants, lane);
  }
  const Lanes no_loads[kJoints] = {};
  const double no_load[kJoints] = {};
  bool moved_to_stop = false;
  for (int step = 0; step < 20000; ++step) {
    Lanes volts[kJoints];
    for (int lane = 0; lane < kLanes; ++lane) {
      double own[kJoints];
      for (std::size_t i = 0; i < kJoints; ++i) {
        own[i] = 8.0 * std::sin(step * 2.5e-4 * (1.0 + static_cast<double>(i)) * (1.0 + 0.2 * lane));
        volts[i][lane] = own[i];
      }
      advance(single[lane], state[lane], own, no_load, 0.25e-3, worn);
      moved_to_stop = moved_to_stop || state[lane].q[0] == 1.2;
    }
    if (!advance(plants, states, volts, no_loads, 0.25e-3, worn)) return std::puts("not settled"), 1;
    State<Lanes> expected{};
    for (int lane = 0; lane < kLanes; ++lane) put(state[lane], expected, lane);
    if (std::memcmp(&expected, &states, sizeof states) != 0) return std::printf("lanes differ in step %d\n", step), 1;
  }
  return moved_to_stop ? 0 : (std::puts("no arm reached a stop"), 1);
}

}  // namespace

int main() { return compare(false) + compare(true); }
