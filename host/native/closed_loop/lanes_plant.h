// One step of the arm for sixteen candidates in single precision: the links' equations of sim/arm/rigid_body.h, and
// those of step.h and conditions.h arranged for speed.
//
// What depends on the candidate and the step alone is worked out beforehand, so that choosing a side picks a constant.
// The link's angle is a whole number of 2^-30 turns and the motor's is kept as its lead over the link, so that no step
// is lost in rounding. Stops cost much and are rarely met: a step is first tried without them. `kWorn` is that of
// conditions.h.
#pragma once

#include <cstddef>
#include <cstdint>

#include "arm/rigid_body.h"

namespace greywhale::loop::GREYWHALE_INSTRUCTIONS {

constexpr int kQuarterBits = 28;  // a quarter turn is 2^28
constexpr float kRadian = static_cast<float>(1073741824.0 / 6.283185307179586);
constexpr float kUnit = static_cast<float>(6.283185307179586 / 1073741824.0);  // rad
constexpr int kPasses = 8;

using Body = arm::RigidBody<Float>;
using Geometry = arm::Geometry<Float>;

// One joint over one step; impulses in N m s. Of each pair the first is with teeth apart, the second with teeth
// touching.
struct Joint {
  Float rotor;    // inertia of the motor side
  Float impulse;  // per PWM compare step
  Float coulomb, stribeck, per_stribeck_velocity, breakaway;
  Float spring, gap_push, no_pull, gap;
  Float mesh;  // per closing velocity, without grease
  Float stiff[2], give[2], share[2], inertia[2];
  Int stop_min, stop_max;
  // Of worn joints: the motor side's inertia with its damping, what friction adds per impulse passed on, the speed of
  // creep, friction per velocity of a side that creeps, and 1 for one that may.
  Float damped, load, creep_velocity, creep, creeps;
};

struct State {
  Int q;
  Float v;
  Float lead;  // motor ahead of link, rad
  Float motor_v;
};

struct Plant {
  Body body;
  Joint joints[4];
  Float step;    // s
  Float travel;  // 2^-30 turns per rad/s
  Float per_step;
  bool rigid;  // some joint has no room between its stops, so it is always at one
};

GREYWHALE_INLINE Float negate_where(Float a, Int bit31) { return float_of_bits(bits_of(a) ^ (bit31 & all(INT32_MIN))); }
GREYWHALE_INLINE Float absolute(Float a) { return float_of_bits(bits_of(a) & all(INT32_MAX)); }
GREYWHALE_INLINE Float sign(Float a) {
  return choose(a > all(0.0f), all(1.0f), choose(a < all(0.0f), all(-1.0f), all(0.0f)));
}

// Cephes' polynomials on +-1/8 turn; 1 unit in the last place or so.
GREYWHALE_INLINE void sine_cosine(Int q, Float& sine, Float& cosine) {
  const Int quarter = shift_right_signed<kQuarterBits>(q + all(1 << (kQuarterBits - 1)));
  const Float x = to_float(q - shift_left<kQuarterBits>(quarter)) * all(kUnit);
  const Float z = x * x;
  const Float s = x + x * z * (all(-1.6666654611e-1f) + z * (all(8.3321608736e-3f) + z * all(-1.9515295891e-4f)));
  const Float c =
      all(1.0f) - all(0.5f) * z +
      z * z * (all(4.166664568298827e-2f) + z * (all(-1.388731625493765e-3f) + z * all(2.443315711809948e-5f)));
  const Mask odd = negative(shift_left<31>(quarter));
  sine = negate_where(choose(odd, c, s), shift_left<30>(quarter));
  cosine = negate_where(choose(odd, s, c), shift_left<30>(quarter + all(1)));
}

GREYWHALE_INLINE Geometry geometry_of(const Body& body, const State (&s)[4]) {
  return arm::geometry_of(body, arm::pose_of<Float>(s[1].q, s[2].q));
}

// The links' momentum with what bias torques do to it over the step.
GREYWHALE_INLINE void momentum_of(const Geometry& g, Float step, const State (&s)[4], Float (&momentum)[4]) {
  const Float v[4] = {s[0].v, s[1].v, s[2].v, s[3].v};
  Float bias[4];
  arm::bias_torque(g, v, bias);
  arm::momentum_of(g.mass, v, momentum);
  for (int i = 0; i < 4; ++i) momentum[i] = momentum[i] - step * bias[i];
}

// A joint's terms in this step, and the sides tried: -1, 0 or +1.
struct Trial {
  Float impulse, friction, push;
  Float mesh, slip, stop;
};

// `first_guess` of conditions.h.
template <bool kWorn>
GREYWHALE_INLINE Float first_slip(const Joint& j, const State& s, const Trial& t) {
  const Float zero = all(0.0f);
  const Mask touching = t.mesh != zero;
  const Float push = choose(touching, t.push - t.mesh * j.gap_push, zero);
  const Float passed = push - choose(touching, j.stiff[1], j.stiff[0]) * s.v;
  const Float needed = t.impulse - passed;
  Float friction = t.friction, breakaway = j.breakaway, slides = sign(s.motor_v);
  if (kWorn) {
    const Float more = j.load * absolute(passed);
    friction = friction + more;
    breakaway = breakaway + more;
    slides = choose(absolute(s.motor_v) > j.creep_velocity, slides, zero);
  }
  const Float starts = choose(absolute(needed) > breakaway, sign(needed), zero);
  return choose(slides * needed > absolute(slides) * friction, slides, starts);
}

template <bool kWorn>
GREYWHALE_INLINE Trial first_trial(const Plant& plant, const Joint& j, const State& s, Float duty) {
  const Float ratio = s.motor_v * j.per_stribeck_velocity;
  Trial t;
  t.impulse = j.rotor * s.motor_v + j.impulse * duty;
  t.friction = j.coulomb + j.stribeck / (all(1.0f) + ratio * ratio);
  t.push = j.spring * s.lead;
  const Float ahead = s.lead + plant.step * (s.motor_v - s.v);
  const Float side = choose(ahead < all(0.0f), all(-1.0f), all(1.0f));
  t.mesh = choose(absolute(ahead) >= j.gap, side, all(0.0f));
  t.slip = first_slip<kWorn>(j, s, t);
  t.stop = choose(s.q >= j.stop_max, all(1.0f), choose(j.stop_min >= s.q, all(-1.0f), all(0.0f)));
  return t;
}

// What motor and mesh add to the link's equation, and what is needed to find the motor's velocity.
struct Row {
  Mask touching, slides, moves;
  Float push, driven, stiff, give, share;
  Float diagonal, right;
  Float inertia, felt;  // of worn joints, as in Mesh of conditions.h
};

GREYWHALE_INLINE Mask worn_lanes(const Joint& j) { return (j.load > all(0.0f)) | (j.creeps != all(0.0f)); }

template <bool kWorn>
GREYWHALE_INLINE Row row_of(const Joint& j, const Trial& t, Float inertia, Float momentum) {
  const Float zero = all(0.0f), one = all(1.0f);
  Row r;
  r.touching = t.mesh != zero;
  r.slides = t.slip != zero;
  r.push = choose(r.touching, t.push - t.mesh * j.gap_push, zero);
  r.stiff = choose(r.touching, j.stiff[1], j.stiff[0]);
  if (kWorn) {
    r.moves = r.slides | (j.creeps != zero);
    r.felt = one + t.slip * t.mesh * j.load;
    r.inertia = j.damped + choose(r.slides, zero, j.creep);
    // Lanes that are not worn keep the bits that they have among their like.
    const Mask worn = worn_lanes(j);
    const Float give = one / (r.inertia + r.felt * r.stiff);
    r.give = choose(worn, give, choose(r.touching, j.give[1], j.give[0]));
    const Float share = choose(worn, r.stiff * give, choose(r.touching, j.share[1], j.share[0]));
    const Float passed_on = choose(worn, share * r.inertia, choose(r.touching, j.inertia[1], j.inertia[0]));
    r.driven = t.impulse - r.felt * r.push - t.slip * t.friction;
    r.diagonal = inertia + choose(r.moves, passed_on, r.stiff);
    r.right = momentum + r.push + choose(r.moves, share * r.driven, zero);
    r.share = r.felt * share;
    return r;
  }
  r.moves = r.slides;
  r.inertia = j.damped;
  r.felt = one;
  r.give = choose(r.touching, j.give[1], j.give[0]);
  r.share = choose(r.touching, j.share[1], j.share[0]);
  r.driven = t.impulse - r.push - t.slip * t.friction;
  r.diagonal = inertia + choose(r.slides, choose(r.touching, j.inertia[1], j.inertia[0]), r.stiff);
  r.right = momentum + r.push + choose(r.slides, r.share * r.driven, zero);
  return r;
}

GREYWHALE_INLINE Float motor_velocity(const Row& r, Float link_v) {
  return choose(r.moves, r.driven * r.give + r.share * link_v, all(0.0f));
}

// The side a gear without a gap pushes to, and the direction of sliding, where friction grows with the load.
GREYWHALE_INLINE void correct_worn(const Joint& j, const Row& r, const Trial& t, Float motor_v, Float v, Float& mesh,
                                   Float& slip) {
  const Float zero = all(0.0f);
  const Float left = t.impulse - t.slip * t.friction - r.inertia * motor_v;
  const Float passed = choose(r.moves, left / r.felt, r.push - r.stiff * v);
  const Float turned = choose(t.mesh * passed < zero - j.no_pull, zero - t.mesh, t.mesh);
  mesh = choose(j.load > zero, choose(j.gap > zero, mesh, turned), mesh);
  const Float sound = t.impulse - r.push - r.stiff * (motor_v - v);
  const Float needed = choose(worn_lanes(j), t.impulse - passed - j.damped * motor_v, sound);
  const Float starts = choose(absolute(needed) > j.breakaway + j.load * absolute(passed), sign(needed), zero);
  const Float slides_on = choose(t.slip * motor_v < j.creep_velocity, zero, t.slip);
  slip = choose(r.slides, slides_on, starts);
}

// The sides that these velocities really ask for; where they differ from those tried.
template <bool kWorn>
GREYWHALE_INLINE Mask correct(const Plant& plant, const Joint& j, const State& s, const Row& r, Float v, Trial& t) {
  const Float zero = all(0.0f), one = all(1.0f);
  const Float motor_v = motor_velocity(r, v);
  const Float closing = motor_v - v;
  const Float push = t.push + j.mesh * closing;
  const Float ahead = s.lead + plant.step * closing;
  const Float meeting = choose(absolute(ahead) > j.gap, choose(ahead < zero, all(-1.0f), one), zero);
  const Float meets = choose(meeting * push > j.gap_push, meeting, zero);
  const Float stays = choose(t.mesh * push < j.gap_push - j.no_pull, zero, t.mesh);
  Float mesh = choose(j.gap > zero, choose(r.touching, stays, meets), t.mesh);

  Float slip;
  if (kWorn) {
    correct_worn(j, r, t, motor_v, v, mesh, slip);
  } else {
    const Float needed = t.impulse - r.push - r.stiff * closing;
    const Float starts = choose(absolute(needed) > j.breakaway, sign(needed), zero);
    const Float slides_on = choose(t.slip * motor_v < zero, zero, t.slip);
    slip = choose(r.slides, slides_on, starts);
  }
  const Mask changed = (mesh != t.mesh) | (slip != t.slip);
  t.mesh = mesh;
  t.slip = slip;
  return changed;
}

GREYWHALE_INLINE void solve_pair(const Row& a, const Row& b, Float coupling, Float& va, Float& vb) {
  const Float scale = all(1.0f) / (a.diagonal * b.diagonal - coupling * coupling);
  va = (b.diagonal * a.right - coupling * b.right) * scale;
  vb = (a.diagonal * b.right - coupling * a.right) * scale;
}

GREYWHALE_INLINE Int travelled(const Plant& plant, Float v) {
  const Float most = all(536870912.0f);  // half a turn: beyond it lies a stop
  return to_nearest(greatest(least(plant.travel * v, most), all(0.0f) - most));
}

// With a link that its stop holds its velocity is given instead.
GREYWHALE_INLINE void solve_held(const Row& a, const Row& b, Float coupling, const Trial& ta, const Trial& tb, Float ga,
                                 Float gb, Float& va, Float& vb) {
  const Float zero = all(0.0f), one = all(1.0f);
  const Mask held_a = ta.stop != zero, held_b = tb.stop != zero;
  const Float aa = choose(held_a, one, a.diagonal), bb = choose(held_b, one, b.diagonal);
  const Float ab = choose(held_a, zero, coupling), ba = choose(held_b, zero, coupling);
  const Float ar = choose(held_a, ga, a.right), br = choose(held_b, gb, b.right);
  const Float scale = one / (aa * bb - ab * ba);
  va = (bb * ar - ab * br) * scale;
  vb = (aa * br - ba * ar) * scale;
}

// A stop holds a link that would pass it and lets go of one that it would have to pull, unless there is no room to go.
GREYWHALE_INLINE Mask correct_stop(const Joint& j, Int reached, Float impulse, Trial& t) {
  const Float zero = all(0.0f);
  const Float arrives = choose(reached > j.stop_max, all(1.0f), choose(reached < j.stop_min, all(-1.0f), zero));
  const Float stays = choose(t.stop * impulse > j.no_pull, zero, t.stop);
  const Float stop = choose(t.stop != zero, choose(j.stop_max > j.stop_min, stays, t.stop), arrives);
  const Mask changed = stop != t.stop;
  t.stop = stop;
  return changed;
}

template <bool kWorn>
GREYWHALE_INLINE void rows_of(const Plant& plant, const Geometry& g, const Float (&momentum)[4], const Trial (&t)[4],
                              Row (&r)[4]) {
  r[0] = row_of<kWorn>(plant.joints[0], t[0], g.mass.m00, momentum[0]);
  r[1] = row_of<kWorn>(plant.joints[1], t[1], g.mass.m11, momentum[1]);
  r[2] = row_of<kWorn>(plant.joints[2], t[2], g.mass.m22, momentum[2]);
  r[3] = row_of<kWorn>(plant.joints[3], t[3], g.mass.m33, momentum[3]);
}

GREYWHALE_INLINE Float finished(const Row& r, Float slip, Float v) {
  const Float motor_v = motor_velocity(r, v);
  return choose(slip * motor_v < all(0.0f), all(0.0f), motor_v);
}

// With stops: the same, for the few steps in which a link is at one.
template <bool kWorn>
__attribute__((noinline)) void advance_at_stops(const Plant& plant, const Geometry& g, State (&s)[4],
                                                const Float (&duty)[4]) {
  Trial t[4];
  Row r[4];
  Float momentum[4];
  for (int i = 0; i < 4; ++i) t[i] = first_trial<kWorn>(plant, plant.joints[i], s[i], duty[i]);
  momentum_of(g, plant.step, s, momentum);
  Float v[4], stops[4];
  Trial used[4];
  bool changed = true;
  for (int pass = 0; pass < kPasses && changed; ++pass) {
    Float arriving[4];
    for (int i = 0; i < 4; ++i) {
      const Joint& j = plant.joints[i];
      const Int way = choose(t[i].stop > all(0.0f), j.stop_max, j.stop_min) - s[i].q;
      arriving[i] = to_float(way) * all(kUnit) * plant.per_step;
      used[i] = t[i];
    }
    rows_of<kWorn>(plant, g, momentum, t, r);
    solve_held(r[0], r[3], g.mass.m03, t[0], t[3], arriving[0], arriving[3], v[0], v[3]);
    solve_held(r[1], r[2], g.mass.m12, t[1], t[2], arriving[1], arriving[2], v[1], v[2]);
    stops[0] = r[0].diagonal * v[0] + g.mass.m03 * v[3] - r[0].right;
    stops[1] = r[1].diagonal * v[1] + g.mass.m12 * v[2] - r[1].right;
    stops[2] = g.mass.m12 * v[1] + r[2].diagonal * v[2] - r[2].right;
    stops[3] = g.mass.m03 * v[0] + r[3].diagonal * v[3] - r[3].right;
    Mask any_changed = all(0) != all(0);
    for (int i = 0; i < 4; ++i) {
      const Joint& j = plant.joints[i];
      any_changed = any_changed | correct<kWorn>(plant, j, s[i], r[i], v[i], t[i]);
      any_changed = any_changed | correct_stop(j, s[i].q + travelled(plant, v[i]), stops[i], t[i]);
    }
    changed = any(any_changed);
  }
  const Float rest = all(0.0f);
  Float after[4];
  solve_held(r[0], r[3], g.mass.m03, used[0], used[3], rest, rest, after[0], after[3]);
  solve_held(r[1], r[2], g.mass.m12, used[1], used[2], rest, rest, after[1], after[2]);
  const Mask blow = (used[0].stop != rest) | (used[1].stop != rest) | (used[2].stop != rest) | (used[3].stop != rest);
  for (int i = 0; i < 4; ++i) {
    const Joint& j = plant.joints[i];
    const Int reached = s[i].q + travelled(plant, v[i]);
    const Mask beyond = (reached > j.stop_max) | (reached < j.stop_min);
    const Int q = least(greatest(reached, j.stop_min), j.stop_max);
    const Float link = choose(beyond, to_float(q - s[i].q) * all(kUnit), plant.step * v[i]);
    s[i].lead = s[i].lead + (plant.step * motor_velocity(r[i], v[i]) - link);
    s[i].q = q;
    s[i].v = choose(blow, after[i], v[i]);
    s[i].motor_v = finished(r[i], used[i].slip, s[i].v);
  }
}

template <bool kWorn>
GREYWHALE_INLINE void advance(const Plant& plant, const Geometry& g, State (&s)[4], const Float (&duty)[4]) {
  if (__builtin_expect(plant.rigid, 0)) {
    advance_at_stops<kWorn>(plant, g, s, duty);
    return;
  }
  Trial t[4];
  Row r[4];
  Float momentum[4];
  for (int i = 0; i < 4; ++i) t[i] = first_trial<kWorn>(plant, plant.joints[i], s[i], duty[i]);
  momentum_of(g, plant.step, s, momentum);
  Float v[4], slip[4];
  bool changed = true;
  for (int pass = 0; pass < kPasses && changed; ++pass) {
    rows_of<kWorn>(plant, g, momentum, t, r);
    solve_pair(r[0], r[3], g.mass.m03, v[0], v[3]);
    solve_pair(r[1], r[2], g.mass.m12, v[1], v[2]);
    Mask any_changed = all(0) != all(0);
    for (int i = 0; i < 4; ++i) {
      slip[i] = t[i].slip;
      any_changed = any_changed | correct<kWorn>(plant, plant.joints[i], s[i], r[i], v[i], t[i]);
    }
    changed = any(any_changed);
  }
  Int q[4];
  Mask at_stop = all(0) != all(0);
  for (int i = 0; i < 4; ++i) {
    const Joint& j = plant.joints[i];
    q[i] = s[i].q + travelled(plant, v[i]);
    at_stop = at_stop | (greatest(q[i], s[i].q) >= j.stop_max) | (j.stop_min >= least(q[i], s[i].q));
  }
  if (__builtin_expect(any(at_stop), 0)) {
    advance_at_stops<kWorn>(plant, g, s, duty);
    return;
  }
  for (int i = 0; i < 4; ++i) {
    s[i].q = q[i];
    s[i].lead = s[i].lead + (plant.step * motor_velocity(r[i], v[i]) - plant.step * v[i]);
    s[i].v = v[i];
    s[i].motor_v = finished(r[i], slip[i], v[i]);
  }
}

}  // namespace greywhale::loop::GREYWHALE_INSTRUCTIONS
