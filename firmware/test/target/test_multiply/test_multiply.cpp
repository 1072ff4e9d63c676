// hal::multiply on the chip is the product that the compiler makes, at all extremes and at random.
#include <Arduino.h>
#include <hal.h>
#include <multiply.h>

#include "../report.h"

namespace {

uint16_t state = 1;

int16_t next_random() {   // xorshift, full period
  state = static_cast<uint16_t>(state ^ (state << 7));
  state = static_cast<uint16_t>(state ^ (state >> 9));
  state = static_cast<uint16_t>(state ^ (state << 8));
  return static_cast<int16_t>(state);
}

bool right(int16_t a, int16_t b) {
  volatile int16_t x = a, y = b;   // the compiler must not know them
  return hal::multiply(x, y) == static_cast<int32_t>(x) * y;
}

}  // namespace

void setup() {
  constexpr int16_t extremes[] = {0, 1, -1, 2, 127, 128, -128, -129, 255, 256, -256, 257, 16384, -16384, 32767, -32767, -32768};
  uint16_t wrong = 0, wrong_at_random = 0;
  for (const int16_t a : extremes) {
    for (const int16_t b : extremes) wrong += !right(a, b);
  }
  for (uint16_t i = 0; i < 20000; ++i) {
    const int16_t a = next_random();
    wrong_at_random += !right(a, next_random());
  }
  hal::begin();
  EQUAL("extremes", wrong, 0);
  EQUAL("random_factors", wrong_at_random, 0);
  report::end();
}

void loop() {}
