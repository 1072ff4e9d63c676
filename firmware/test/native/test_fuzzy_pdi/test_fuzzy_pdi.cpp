// The law's landmarks on the native build; the bit-for-bit and error-bound tests live in tests/fuzzy.
#include <doctest/doctest.h>

#include <fuzzy_pdi.h>
#include <inference.h>

using namespace fuzzy_pdi;

namespace {

// The paper's sets before tuning, joint 0's scaling factors, 15 V.
const Settings before = {-4915, -4915, 4915, 4915, -1638, -1638, 1638, 1638, 33620, 10486, 20513, 15000, 1};

Coefficients compiled(const Settings& settings, uint8_t period_ms = 20) {
  Coefficients c = {};
  REQUIRE(compile(settings, period_ms, c) == Refusal::none);
  return c;
}

Output first(const Settings& settings, int16_t leader, int16_t follower, uint16_t limit = 15000) {
  const Coefficients c = compiled(settings);
  State state;
  reset(c, state);
  return step(c, state, leader, follower, limit);
}

}  // namespace

TEST_CASE("no error gives no voltage") {
  const Output out = first(before, 1000, 1000);
  CHECK(out.u_fuzzy == 0);
  CHECK(out.volts_mv == 0);
  CHECK_FALSE(out.saturated);
  CHECK_FALSE(out.no_rule);
}

TEST_CASE("beyond PE's plateau the output is full") {
  Settings s = before;
  s.ki = 0;
  const Output up = first(s, 4096, 0);  // Kp e = 0.513 > 0.3
  CHECK(up.u_fuzzy == 32767);
  CHECK(up.volts_mv == 15000);
  CHECK_FALSE(up.saturated);
  const Output down = first(s, 0, 4096);
  CHECK(down.u_fuzzy == -32767);
  CHECK(down.volts_mv == -15000);
}

TEST_CASE("on a partition of unity u_fuzzy is the line x / 0.3") {
  Settings s = before;
  s.ki = 0;
  s.kp = 65536;
  for (int16_t e = -1228; e <= 1228; e = static_cast<int16_t>(e + 7)) {
    const double exact = e / 4096.0 * 16384.0 / 4915.0 * 32768.0;
    CHECK(first(s, e, 0).u_fuzzy == doctest::Approx(exact).epsilon(1e-9).scale(1e9));
    CHECK(first(s, e, 0).u_fuzzy - exact <= 0.51);
    CHECK(first(s, e, 0).u_fuzzy - exact >= -0.51);
  }
}

TEST_CASE("the integral is exact and waits while the output is saturated on the error's side") {
  Settings s = before;
  s.ku_mv = 0;
  s.ki = 65536;  // 1 V per rad and second
  const Coefficients c = compiled(s, 20);
  State state;
  reset(c, state);
  for (int i = 1; i <= 1000; ++i) CHECK(step(c, state, 4096, 0, 30000).volts_mv == 20 * i);  // 1 rad for 20 ms a step
  for (int i = 0; i < 10; ++i) {
    const Output out = step(c, state, 4096, 0, 20000);
    CHECK(out.volts_mv == 20000);
    CHECK(out.saturated);
  }
  CHECK(step(c, state, -4096, 0, 20000).volts_mv == 19980);
}

TEST_CASE("the integral is held within 2^15 mV") {
  Settings s = before;
  s.ku_mv = 30000;
  s.kp = 0;
  s.kd = 64UL << 16;
  s.ki = 20UL << 16;
  const Coefficients c = compiled(s, 4);
  State state;
  reset(c, state);
  step(c, state, 32767, 0, 30000);
  // A shrinking error: the proportional part pulls down with all its 30 V while the integral grows.
  for (int16_t e = 32000; e > 3000; e = static_cast<int16_t>(e - 200))
    CHECK(step(c, state, e, 0, 30000).u_fuzzy == -32767);
  CHECK(state.integral == (int32_t{1} << 30) - 1);
  CHECK(state.fraction == 0xFFFF);
  reset(c, state);
  step(c, state, 0, 32767, 30000);
  for (int16_t e = 32000; e > 3000; e = static_cast<int16_t>(e - 200))
    CHECK(step(c, state, 0, e, 30000).u_fuzzy == 32767);
  CHECK(state.integral == -(int32_t{1} << 30));
  CHECK(state.fraction == 0);
}

TEST_CASE("the first change of error is zero, also after a reset") {
  Settings s = before;
  s.ki = 0;
  s.kp = 0;
  s.kd = 65536;
  const Coefficients c = compiled(s);
  State state;
  reset(c, state);
  CHECK(step(c, state, 400, 0, 15000).volts_mv == 0);
  CHECK(step(c, state, 500, 0, 15000).volts_mv > 0);
  reset(c, state);
  CHECK(step(c, state, 900, 0, 15000).volts_mv == 0);
}

TEST_CASE("the change of error spans ce_ticks periods, and is zero until there were so many") {
  Settings s = before;
  s.ki = 0;
  s.kp = 0;
  s.ce_ticks = 3;
  const Coefficients c = compiled(s);
  State state;
  reset(c, state);
  const int16_t errors[] = {500, 100, 900};
  for (const int16_t error : errors) CHECK(step(c, state, error, 0, 15000).volts_mv == 0);
  CHECK(step(c, state, 500, 0, 15000).volts_mv == 0);  // as three periods before
  CHECK(step(c, state, 200, 0, 15000).volts_mv > 0);   // 100 then
  CHECK(step(c, state, 800, 0, 15000).volts_mv < 0);   // 900 then
}

TEST_CASE("Kd is stored for 20 ms") {
  Settings whole = before;
  whole.kd = 20 * 1000;
  Settings short_period = before;
  short_period.kd = 1000;
  Settings spanning = whole;
  spanning.ce_ticks = 20;
  const Coefficients a = compiled(whole, 20);
  const Coefficients same[] = {compiled(short_period, 1), compiled(spanning, 1)};
  for (const Coefficients& b : same) {
    CHECK(a.ce[0].zero == b.ce[0].zero);
    CHECK(a.ce[1].outer == b.ce[1].outer);
    CHECK(a.ce[1].short_ramps == b.ce[1].short_ramps);
  }
}

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

TEST_CASE("the quotient is below the true one by less than 0.04 before it is rounded") {
  uint32_t seed = 1;
  for (uint32_t i = 0; i < 40000; ++i) {
    seed = seed * 1664525u + 1013904223u;
    const uint32_t whole = 65536 + (seed >> (6 + i % 10)) % (3 * one - 65536);
    seed = seed * 1664525u + 1013904223u;
    const uint32_t part = static_cast<uint32_t>((static_cast<uint64_t>(seed) * (whole + 1)) >> 32);
    const double exact = 32768.0 * part / whole;
    const double error = ratio_q15(part, whole) - exact;
    REQUIRE(error <= 0.5);
    REQUIRE(error > -0.54);
    REQUIRE(ratio_q15(whole, whole) == 32768);
  }
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
