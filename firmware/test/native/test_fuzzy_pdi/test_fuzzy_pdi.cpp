// The ends of the law's ranges on the native build. What it computes is tested in tests/fuzzy, against the exact law.
#include <doctest/doctest.h>

#include <fuzzy_pdi.h>

using namespace fuzzy_pdi;

namespace {

// The paper's sets before tuning, joint 0's scaling factors, 15 V.
const Settings before = {-4915, -4915, 4915, 4915, -1638, -1638, 1638, 1638, 33620, 10486, 20513, 15000, 1};

Coefficients compiled(const Settings& settings, uint8_t period_ms = 20) {
  Coefficients c = {};
  REQUIRE(compile(settings, period_ms, c) == Refusal::none);
  return c;
}

}  // namespace

TEST_CASE("bad settings are refused with their reason and leave the running set untouched") {
  Coefficients c = compiled(before);
  const uint32_t slope = c.e[0].zero;
  const auto refuses = [&](void (*spoil)(Settings&), uint8_t period = 20) {
    Settings s = before;
    s.kp = 65536;
    spoil(s);
    const Refusal refusal = compile(s, period, c);
    CHECK(c.e[0].zero == slope);
    return refusal;
  };
  CHECK(refuses([](Settings& s) { s.ne_c = 4915; }) == Refusal::order);
  CHECK(refuses([](Settings& s) { s.zce_c = -200; }) == Refusal::order);
  CHECK(refuses([](Settings& s) { s.pe_b = 16385; }) == Refusal::range);
  CHECK(refuses([](Settings& s) { s.zce_a = -16385; }) == Refusal::range);
  CHECK(refuses([](Settings& s) { s.ne_c = 16385; }) == Refusal::range);
  CHECK(refuses([](Settings& s) { s.ze_c = 163; }) == Refusal::width);
  CHECK(refuses([](Settings& s) { s.nce_c = -163; }) == Refusal::width);
  CHECK(refuses([](Settings& s) { s.pce_b = 0; }) == Refusal::width);
  CHECK(refuses([](Settings& s) { s.kp = (64UL << 16) + 1; }) == Refusal::gain);
  CHECK(refuses([](Settings& s) { s.kd = (64UL << 16) + 1; }) == Refusal::gain);
  CHECK(refuses([](Settings& s) { s.ki = (1000UL << 16) + 1; }, 1) == Refusal::gain);
  CHECK(refuses([](Settings& s) { s.ki = 1000UL << 16; }, 5) == Refusal::gain);
  CHECK(refuses([](Settings& s) { s.ku_mv = 30001; }) == Refusal::gain);
  CHECK(refuses([](Settings& s) { s.ce_ticks = 0; }) == Refusal::range);
  CHECK(refuses([](Settings& s) { s.ce_ticks = 21; }) == Refusal::range);
  CHECK(refuses([](Settings&) {}, 0) == Refusal::period);
  CHECK(refuses([](Settings&) {}, 51) == Refusal::period);
}

namespace {

struct Random {
  uint64_t state = 88172645463325252ull;
  uint32_t next() {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return static_cast<uint32_t>(state >> 32);
  }
  // Mostly small, sometimes anything.
  uint32_t some(uint32_t most) { return next() % 4 == 0 ? next() : next() % (most + 1) >> next() % 16; }
  int16_t angle() { return static_cast<int16_t>(next() % 3 == 0 ? next() : next() % 4096); }
  int16_t corner(int sign) {
    return static_cast<int16_t>(next() % 9 == 0 ? next() : sign * static_cast<int>(164 + next() % 16221));
  }
};

}  // namespace

// Under the sanitizers this looks for undefined behaviour in every corner of the ranges.
TEST_CASE("whatever is asked, settings are refused or the output is within the limit") {
  Random random;
  uint32_t taken = 0;
  for (uint32_t i = 0; i < 3000; ++i) {
    const Settings s = {random.corner(-1),
                        random.corner(-1),
                        random.corner(1),
                        random.corner(1),
                        random.corner(-1),
                        random.corner(-1),
                        random.corner(1),
                        random.corner(1),
                        random.some(64UL << 16),
                        random.some(64UL << 16),
                        random.some(1000UL << 16),
                        static_cast<uint16_t>(random.some(30000)),
                        static_cast<uint8_t>(random.next() % 22)};
    Coefficients c = {};
    if (compile(s, static_cast<uint8_t>(random.next() % 60), c) != Refusal::none) continue;
    ++taken;
    State state;
    reset(c, state);
    for (uint32_t k = 0; k < 50; ++k) {
      const uint16_t limit = static_cast<uint16_t>(random.next() % 32768);
      const Output out = step(c, state, random.angle(), random.angle(), limit);
      REQUIRE(out.volts_mv <= limit);
      REQUIRE(out.volts_mv >= -static_cast<int32_t>(limit));
      REQUIRE(out.u_fuzzy != -32768);
      REQUIRE_FALSE(out.no_rule);
      REQUIRE(state.integral < (int32_t{1} << 30));
      REQUIRE(state.integral >= -(int32_t{1} << 30));
    }
  }
  CHECK(taken > 300);
}
