// The controller as one would first write it, in float, to compare cycles with: 3 x 3 rules, min, max, and then the
// centroid of 101 samples (MATLAB's evalfis) or weighted singletons. Joint 0's sets of Table 10.
#include <stdint.h>

namespace {

struct Sets {
  float n_c, z_a, z_c, p_b;
};

const Sets error_sets = {-0.0785f, -0.0920f, 0.0363f, 0.0466f};
const Sets change_sets = {-0.2918f, -0.6524f, 0.2340f, 1.0f};
const uint8_t rules[3][3] = {{0, 0, 1}, {0, 1, 2}, {1, 2, 2}};

float trapezoid(float x, float a, float b, float c, float d) {
  if (x >= b && x <= c) return 1.0f;
  if (x > a && x < b) return (x - a) / (b - a);
  if (x > c && x < d) return (d - x) / (d - c);
  return 0.0f;
}

float lesser(float a, float b) { return a < b ? a : b; }
float greater(float a, float b) { return a < b ? b : a; }

void fuzzify(float x, const Sets& sets, float (&degree)[3]) {
  degree[0] = trapezoid(x, -1.0f, -1.0f, sets.n_c, 0.0f);
  degree[1] = trapezoid(x, sets.z_a, 0.0f, 0.0f, sets.z_c);
  degree[2] = trapezoid(x, 0.0f, sets.p_b, 1.0f, 1.0f);
}

void fire(float x, float y, float (&height)[3]) {
  float e[3], ce[3];
  fuzzify(x, error_sets, e);
  fuzzify(y, change_sets, ce);
  height[0] = height[1] = height[2] = 0.0f;
  for (uint8_t i = 0; i < 3; ++i) {
    for (uint8_t j = 0; j < 3; ++j) height[rules[i][j]] = greater(height[rules[i][j]], lesser(e[i], ce[j]));
  }
}

}  // namespace

extern "C" float fuzzy_float_mamdani(float x, float y) {
  float height[3];
  fire(x, y, height);
  const float half_width = 0.01f;
  float area = 0.0f, moment = 0.0f;
  for (int8_t k = -50; k <= 50; ++k) {
    const float u = 0.02f * k;
    float degree = 0.0f;
    for (int8_t set = -1; set <= 1; ++set) {
      degree = greater(degree, lesser(height[set + 1], trapezoid(u, set - half_width, set, set, set + half_width)));
    }
    area += degree;
    moment += degree * u;
  }
  return area > 0.0f ? moment / area : 0.0f;
}

extern "C" float fuzzy_float_singletons(float x, float y) {
  float height[3];
  fire(x, y, height);
  const float sum = height[0] + height[1] + height[2];
  return sum > 0.0f ? (height[2] - height[0]) / sum : 0.0f;
}

int main() {
  for (;;) {
  }
}
