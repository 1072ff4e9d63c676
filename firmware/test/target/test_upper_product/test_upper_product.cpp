// The upper half of a product in assembly is its portable form's, at all extremes and at random.
#include <hal.h>
#include <signal_chain/upper_product.h>

#include "../report.h"

namespace {

// Volatile, so that the compiler does not know the factors.
bool is_right(uint16_t a, uint16_t b) {
  volatile uint16_t x = a, y = b;
  return signal_chain::upper_product(x, y) == signal_chain::upper_product_portable(x, y);
}

}  // namespace

int main() {
  constexpr uint16_t extremes[] = {0, 1, 2, 127, 128, 255, 256, 257, 4092, 16384, 32767, 32768, 65280, 65472, 65535};
  uint16_t wrong = 0, wrong_at_random = 0;
  for (const uint16_t a : extremes) {
    for (const uint16_t b : extremes) wrong += !is_right(a, b);
  }
  for (uint16_t i = 0; i < 60000; ++i) {
    const uint16_t a = next_random();
    wrong_at_random += !is_right(a, static_cast<uint16_t>(next_random() ^ i));
  }
  hal::begin();
  EQUAL("extremes", wrong, 0);
  EQUAL("random_factors", wrong_at_random, 0);
  report::end();
}
