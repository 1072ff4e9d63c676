// Reads doubles from stdin; writes of each the sine, the cosine, the logarithm, the logarithm of 1 and it, and the
// exponential.
#include "elementary.h"

#include <cstdio>

using namespace greywhale::arm;

int main() {
  double x;
  while (std::fread(&x, sizeof x, 1, stdin) == 1) {
    double found[5];
    sine_cosine(x, found[0], found[1]);
    found[2] = logarithm(x);
    found[3] = logarithm_of_1_and(x);
    found[4] = exponential(x);
    std::fwrite(found, sizeof found, 1, stdout);
  }
}
