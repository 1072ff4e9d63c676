// The firmware's tick for sixteen candidates: filter, angle, fuzzy PD+I law, duty, in the same integers with the same
// bits. The law is firmware/lib/fuzzy_pdi (fuzzy_pdi.cpp, inference.h, arithmetic.h), line by line; a test holds one
// against the other.
#pragma once

#include <cstddef>
#include <cstdint>

#include "block.h"
#include "fuzzy_pdi.h"

namespace greywhale::loop::GREYWHALE_INSTRUCTIONS {

// One side of one input; a short ramp's size is scaled up by 2^8.
struct Side {
  Int zero, outer, zero_shift, outer_shift;
};

struct Law {
  Side e[2], ce[2];
  Int integral, ku, ce_ticks;
  Int behind;  // in Memory::errors, from a row to a lane's error of ce_ticks periods before
};

// The last errors of sixteen joints, a row a control period.
constexpr std::size_t kErrors = 32;
static_assert(kErrors > fuzzy_pdi::most_ce_ticks && (kErrors & (kErrors - 1)) == 0, "a power of two");

struct Memory {
  Int integral, fraction;
  std::size_t periods;
  std::int32_t errors[kErrors * kBlock];
};

GREYWHALE_INLINE void reset(Memory& memory) {
  memory.integral = memory.fraction = all(0);
  memory.periods = 0;
  for (std::size_t row = 0; row < kErrors; ++row) store(memory.errors + row * kBlock, all(0));
}

// The error's change over each lane's ce_ticks; 0 while there have been fewer periods.
GREYWHALE_INLINE Int change_of(const Law& law, Memory& memory, Int error) {
  constexpr std::int32_t kPlaces = kErrors * kBlock;
  const auto now = static_cast<std::int32_t>(memory.periods % kErrors * kBlock);
  store(memory.errors + now, error);
  const Int before = pick(memory.errors, (all(now) - law.behind) & all(kPlaces - 1));
  const Mask early = law.ce_ticks > all(static_cast<std::int32_t>(memory.periods));
  ++memory.periods;
  const Int furthest = all(32767);
  const Int change = greatest(least(error - before, furthest), all(0) - furthest);
  return choose(early, all(0), change);
}

struct Heights {
  Int zero, outer;
};

struct Product {
  Int whole, fraction;
};

constexpr std::int32_t kOne = 0xFFFFFF;

GREYWHALE_INLINE Product multiply(Int size, Int factor) {
  const Int low = size * (factor & all(0xFFFF));
  return {size * shift_right<16>(factor) + shift_right<16>(low), low & all(0xFFFF)};
}

// `short_ramps`: whether any lane has one, so that the others' time is not spent on them.
GREYWHALE_INLINE Int climb(Int slope, Int shift, Int size, bool short_ramps) {
  const Int scaled = short_ramps ? shift_left(size, shift) : size;
  const Int low = scaled * (slope & all(0xFFFF));
  const Int height = scaled * shift_right<16>(slope) + shift_right<16>(low + all(0x8000));
  // As an unsigned number it may be beyond 2^31, which is seen as negative here.
  const Int clipped = choose(negative(height), all(kOne), least(height, all(kOne)));
  return short_ramps ? choose(scaled > all(0xFFFF), all(kOne), clipped) : clipped;
}

GREYWHALE_INLINE Heights fuzzify(const Side (&sides)[2], Mask below, Int size, bool short_ramps) {
  const Int zero = choose(below, sides[1].zero, sides[0].zero);
  const Int outer = choose(below, sides[1].outer, sides[0].outer);
  const Int zero_shift = short_ramps ? choose(below, sides[1].zero_shift, sides[0].zero_shift) : all(0);
  const Int outer_shift = short_ramps ? choose(below, sides[1].outer_shift, sides[0].outer_shift) : all(0);
  return {all(kOne) - climb(zero, zero_shift, size, short_ramps), climb(outer, outer_shift, size, short_ramps)};
}

GREYWHALE_INLINE Int ratio_q15(Int part, Int whole) {
  const Int down = choose(whole >= all(1 << 25), all(2), choose(whole >= all(1 << 24), all(1), all(0)));
  const Int small = shift_right(whole, down);
  const Int up = all(23) - highest_bit(small);
  part = shift_left(shift_right(part, down), up);
  whole = shift_left(small, up);

  // The table of reciprocals, 131072 / (257 + i): the quotient is never close below a whole number, so the division is
  // safe.
  const Int r = to_int(all(131072.0f) / to_float(all(257) + (shift_right<15>(whole) & all(255))));
  const Int rest = shift_right<9>(all(-1) - whole * r);
  const Int coarse = shift_right<8>(rest);
  const Int series = rest + shift_right<7>(coarse * coarse);
  const Int first = shift_right<8>(part * r);
  const Int high = shift_right<16>(first);
  const Int low = shift_right<8>(first) & all(255);
  const Int fine = shift_right<8>(series);
  const Int more = high * fine + shift_right<8>(high * (series & all(255))) + shift_right<8>(low * fine);
  return shift_right<1>(shift_right<8>(first + shift_left<1>(more)) + all(1));
}

struct Voltage {
  Int size;
  Mask negative;
};

GREYWHALE_INLINE Voltage sum(Int proportional, Int integral) {
  const Int total = proportional + integral;
  return {shift_right<15>(absolute(total) + all(0x4000)), negative(total)};
}

// What the rules say of one joint, before the division.
struct Fired {
  Int e_size, part, whole;
  Mask e_below, backwards, fires;
};

GREYWHALE_INLINE Fired fire(const Law& law, Memory& memory, Int leader, Int follower, bool short_ramps) {
  const Int furthest = all(32767);
  const Int error = greatest(least(leader - follower, furthest), all(0) - furthest);
  const Int change = change_of(law, memory, error);

  Fired f;
  f.e_below = negative(error);
  f.e_size = absolute(error);
  const Mask opposite = f.e_below ^ negative(change);
  const Heights e = fuzzify(law.e, f.e_below, f.e_size, short_ramps);
  const Heights ce = fuzzify(law.ce, negative(change), absolute(change), short_ramps);

  const Int both_zero = least(e.zero, ce.zero);
  const Int both_outer = least(e.outer, ce.outer);
  const Int outer_zero = least(e.outer, ce.zero);
  const Int zero_outer = least(e.zero, ce.outer);
  const Int with = choose(opposite, outer_zero, greatest(zero_outer, greatest(outer_zero, both_outer)));
  const Int zero = choose(opposite, greatest(both_zero, both_outer), both_zero);
  const Int against = choose(opposite, zero_outer, all(0));

  const Int whole = with + zero + against;
  f.fires = whole >= all(65536);
  f.whole = choose(f.fires, whole, all(65536));
  f.part = absolute(with - against);
  f.backwards = f.e_below ^ ((against > with) & f.fires);
  return f;
}

// The voltage in mV from u_fuzzy's size, and the integral that goes with it.
GREYWHALE_INLINE Int finish(const Law& law, Memory& memory, const Fired& f, Int ratio, Int limit) {
  const Int drive = choose(f.fires, ratio, all(0)) * law.ku;
  const Int proportional = choose(f.backwards, all(0) - drive, drive);

  const Product more = multiply(f.e_size, law.integral);
  const Int fraction = memory.fraction + choose(f.e_below, all(0) - more.fraction, more.fraction);
  const Int integral =
      memory.integral + choose(f.e_below, all(0) - more.whole, more.whole) + shift_right_signed<16>(fraction);
  const Mask above = integral >= all(1 << 30);
  const Mask below = integral < all(-(1 << 30));
  const Int next_integral = choose(above, all((1 << 30) - 1), choose(below, all(-(1 << 30)), integral));
  const Int next_fraction = choose(above, all(0xFFFF), choose(below, all(0), fraction & all(0xFFFF)));

  const Voltage wanted = sum(proportional, next_integral);
  const Mask held = (wanted.size > limit) & ~(wanted.negative ^ f.e_below);
  memory.fraction = choose(held, memory.fraction, next_fraction);
  memory.integral = choose(held, memory.integral, next_integral);
  const Voltage given = sum(proportional, memory.integral);
  const Int size = least(given.size, limit);
  return choose(given.negative, all(0) - size, size);
}

// One control period of N joints, stage by stage, so that the processor works at several joints at a time. The voltages
// in mV.
template <int N>
GREYWHALE_INLINE void step(const Law (&laws)[N], Memory (&memories)[N], const Int (&leader)[N],
                           const Int (&follower)[N], std::int32_t limit_mv, bool short_ramps, Int (&millivolts)[N]) {
  Fired fired[N];
  Int ratio[N];
  for (int i = 0; i < N; ++i) fired[i] = fire(laws[i], memories[i], leader[i], follower[i], short_ramps);
  for (int i = 0; i < N; ++i) ratio[i] = ratio_q15(fired[i].part, fired[i].whole);
  for (int i = 0; i < N; ++i) millivolts[i] = finish(laws[i], memories[i], fired[i], ratio[i], all(limit_mv));
}

GREYWHALE_INLINE Int low_pass(Int old, Int sum, int shift) {
  const Int kept = old * all(256 - (256 >> shift)) + all(128);
  return shift_right<8>(kept) + sum * all(16 >> shift);
}

GREYWHALE_INLINE Int to_angle(Int filtered, std::int32_t zero, std::int32_t scale) {
  return shift_right_signed<15>(filtered * all(scale) + all(0x4000 - 4 * zero * scale));
}

GREYWHALE_INLINE Int compare_value(Int millivolts, std::int32_t scale, std::int32_t sign) {
  const Int compare = shift_right_signed<18>(absolute(millivolts) * all(scale) + all(1 << 17));
  return choose(negative(millivolts * all(sign)), all(0) - compare, compare);
}

}  // namespace greywhale::loop::GREYWHALE_INSTRUCTIONS
