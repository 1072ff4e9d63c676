// The products of multiply.h on the chip are their portable forms, at all extremes and at random.
#include <Arduino.h>
#include <hal.h>
#include <multiply.h>

#include "../report.h"

namespace {

uint16_t state = 1;

uint16_t next_random() {   // xorshift, full period
  state = static_cast<uint16_t>(state ^ (state << 7));
  state = static_cast<uint16_t>(state ^ (state >> 9));
  state = static_cast<uint16_t>(state ^ (state << 8));
  return state;
}

// Volatile, so that the compiler must not know the factors.
bool blend_is_right(uint16_t old, uint8_t keep, uint16_t sum, uint8_t gain) {
  volatile uint16_t o = old, s = sum;
  volatile uint8_t k = keep, g = gain;
  return hal::blend(o, k, s, g) == hal::portable::blend(o, k, s, g);
}

bool line_is_right(uint16_t value, int16_t factor, int32_t offset) {
  volatile uint16_t v = value;
  volatile int16_t f = factor;
  const hal::Offset o = hal::make_offset(offset);
  return hal::line(v, f, o) == hal::portable::line(v, f, o);
}

bool upper_product_is_right(uint16_t a, uint16_t b) {
  volatile uint16_t x = a, y = b;
  return hal::upper_product(x, y) == hal::portable::upper_product(x, y);
}

// Within the range that hal::line() states.
int32_t random_offset() { return static_cast<int32_t>(static_cast<uint32_t>(next_random()) << 14) - (INT32_C(1) << 29); }

}  // namespace

void setup() {
  constexpr uint16_t extremes[] = {0, 1, 2, 127, 128, 255, 256, 257, 4092, 16384, 32767, 32768, 65280, 65472, 65535};
  constexpr int16_t factors[] = {0, 1, -1, 127, 128, -128, -129, 255, 256, -256, 10734, -10734, 16383, 16384, -16384};
  constexpr uint8_t shifts[] = {0, 1, 2, 3, 4};
  constexpr int16_t all_offsets[] = {-32767, -16384, -1, 0, 1, 16384, 32767};
  uint16_t products = 0, lines = 0, blends = 0, wrong_at_random = 0;
  for (const uint16_t a : extremes) {
    for (const uint16_t b : extremes) products += !upper_product_is_right(a, b);
    for (const int16_t f : factors) {
      for (const int16_t o : all_offsets) {
        lines += !line_is_right(a, f, static_cast<int32_t>(o) * 32768);
        lines += !line_is_right(a, f, static_cast<int32_t>(o) * 32768 + 0x4000);
      }
    }
    for (const uint8_t shift : shifts) {
      const uint8_t keep = static_cast<uint8_t>(256 - (256 >> shift)), gain = static_cast<uint8_t>(16 >> shift);
      for (uint16_t sum = 0; sum <= 4092; sum += 31) blends += !blend_is_right(a, keep, sum, gain);
      blends += !blend_is_right(a, keep, 4092, gain);
    }
  }
  for (uint16_t i = 0; i < 20000; ++i) {
    const uint16_t a = next_random(), b = next_random();
    wrong_at_random += !upper_product_is_right(a, b);
    wrong_at_random += !line_is_right(a, static_cast<int16_t>(b) / 2, random_offset());
    wrong_at_random += !blend_is_right(a, static_cast<uint8_t>(b), b & 0x0fff, 16);
  }
  hal::begin();
  EQUAL("upper_products", products, 0);
  EQUAL("lines", lines, 0);
  EQUAL("blends", blends, 0);
  EQUAL("random_factors", wrong_at_random, 0);
  report::end();
}

void loop() {}
