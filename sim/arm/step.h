// One integration step of links, motors, gears, friction and stops.
//
// Each joint is two bodies: the motor side (rotor and gear train, reflected to the output shaft, with all dry friction)
// and the link side. The gear mesh between them is a spring and damper with a dead zone. Everything stiff is taken at
// the end of the step (implicit Euler in the velocities): motor damping, mesh, friction, stops. Velocity terms and
// gravity are taken at its start. The step is linear once it is known which teeth touch, which shafts slide and which
// stops hold, and that is found by trying, for each pair of joints that feel each other: solve, correct, solve again.
// The conditions are monotone, so this ends, mostly in the first pass; a step that does not settle is counted. All of
// it works lane by lane when T is a vector type.
#pragma once

#include <cstddef>

#include "conditions.h"
#include "linear_system.h"
#include "parameters.h"
#include "rigid_body.h"
#include "scalar.h"

namespace greywhale::arm {

template <class T>
struct Plant {
  RigidBody<T> body;
  Joint<T> joints[kJoints];
};

constexpr int kPasses = 8;

namespace detail {

// The links of two joints that feel each other, before motors and gears are added.
template <class T>
struct Links {
  T inertia[2], coupling, momentum[2];
};

template <class T>
GREYWHALE_INLINE bool is_held(const Sides<T> (&sides)[2]) {
  const T zero = constant<T>(0.0);
  return any(either(sides[0].stop != zero, sides[1].stop != zero));
}

template <class T>
GREYWHALE_INLINE auto is_beyond(const Stops<T>& stops, T q) {
  return either(q > stops.max, q < stops.min);
}

// Corrects the sides of mesh and friction by the velocities found with them; where they changed.
template <bool kWorn, class T, class Time>
GREYWHALE_INLINE auto settle(const Joint<T>& joint, const Terms<T>& t, const Mesh<T>& mesh, T motor_v, T v, Time dt,
                             Sides<T>& sides) {
  const Sides<T> side = sides;
  const T closing = motor_v - v;
  sides.mesh = corrected_mesh(joint.gear, t, side.mesh, closing, dt);
  if (kWorn) {
    const T passed = passed_impulse(t, side, mesh, motor_v, v);
    sides.mesh = corrected_gapless(joint.gear, t, sides.mesh, passed);
    sides.slip = corrected_worn_slip(joint.friction, t, side, motor_v, passed);
  } else {
    sides.slip = corrected_slip(t, side, mesh, motor_v, closing);
  }
  return either(sides.mesh != side.mesh, sides.slip != side.slip);
}

// The same of stops, which are rarely met; true when nothing changed.
template <class T, class Time>
bool settle_stops(const Stops<T>& one, const Stops<T>& other, const LinearSystem<T>& system, const T (&q)[2],
                  const T (&v)[2], Time dt, Sides<T> (&sides)[2]) {
  T impulses[2];
  stop_impulses(system, v, impulses);
  const T first = corrected_stop(one, sides[0].stop, q[0] + dt * v[0], impulses[0]);
  const T second = corrected_stop(other, sides[1].stop, q[1] + dt * v[1], impulses[1]);
  const bool settled = !any(either(first != sides[0].stop, second != sides[1].stop));
  sides[0].stop = first;
  sides[1].stop = second;
  return settled;
}

// A link that a stop holds is there exactly at the end of the step.
template <class T, class Time>
void solve_held(const Stops<T>& one, const Stops<T>& other, const LinearSystem<T>& system, const T (&q)[2],
                const Sides<T> (&sides)[2], Time dt, T (&v)[2]) {
  const T zero = constant<T>(0.0);
  const T arriving[2] = {(choose(sides[0].stop > zero, one.max, one.min) - q[0]) / dt,
                         (choose(sides[1].stop > zero, other.max, other.min) - q[1]) / dt};
  solve(system, sides, arriving, v);
}

// Joints `a` and `b`: the other two feel nothing of them within a step.
template <bool kWorn, class T, class Time>
GREYWHALE_INLINE bool advance_pair(const Plant<T>& plant, State<T>& s, std::size_t a, std::size_t b,
                                   const Links<T>& links, const T (&volts)[kJoints], Time dt) {
  const std::size_t joints[2] = {a, b};
  const Joint<T>&one = plant.joints[a], &other = plant.joints[b];
  const T q[2] = {s.q[a], s.q[b]};
  const Terms<T> terms[2] = {terms_of<kWorn>(one, s, a, volts[a], dt), terms_of<kWorn>(other, s, b, volts[b], dt)};
  Sides<T> sides[2] = {first_guess<kWorn>(one, terms[0], s, a, dt), first_guess<kWorn>(other, terms[1], s, b, dt)};
  Sides<T> used[2];
  Mesh<T> meshes[2];
  LinearSystem<T> system;
  T v[2], motor_v[2];
  bool settled = false, held = false;
  for (int pass = 0; pass < kPasses && !settled; ++pass) {
    for (std::size_t n = 0; n < 2; ++n) {
      meshes[n] = mesh_of<kWorn>(terms[n], sides[n]);
      used[n] = sides[n];
    }
    system = linear_system<kWorn>(links.inertia, links.coupling, links.momentum, terms, sides, meshes);
    held = is_held(sides);
    if (held) {
      solve_held(one.stops, other.stops, system, q, used, dt, v);
    } else {
      solve_free(system, v);
    }
    for (std::size_t n = 0; n < 2; ++n) motor_v[n] = motor_velocity<kWorn>(terms[n], used[n], meshes[n], v[n]);
    settled = !any(either(settle<kWorn>(one, terms[0], meshes[0], motor_v[0], v[0], dt, sides[0]),
                          settle<kWorn>(other, terms[1], meshes[1], motor_v[1], v[1], dt, sides[1])));
    if (held || any(either(is_beyond(one.stops, q[0] + dt * v[0]), is_beyond(other.stops, q[1] + dt * v[1]))))
      settled = settle_stops(one.stops, other.stops, system, q, v, dt, sides) && settled;
  }
  for (std::size_t n = 0; n < 2; ++n) {
    const Stops<T>& stops = plant.joints[joints[n]].stops;
    const T reached = q[n] + dt * v[n];
    s.q[joints[n]] = choose(reached > stops.max, stops.max, choose(reached < stops.min, stops.min, reached));
    s.motor_q[joints[n]] = s.motor_q[joints[n]] + dt * motor_v[n];
  }
  if (held) {
    // Impact is inelastic: a link is at rest when it has arrived at its stop, and its neighbour feels all of that blow.
    const T rest[2] = {constant<T>(0.0), constant<T>(0.0)};
    solve(system, used, rest, v);
    for (std::size_t n = 0; n < 2; ++n) motor_v[n] = motor_velocity<kWorn>(terms[n], used[n], meshes[n], v[n]);
  }
  for (std::size_t n = 0; n < 2; ++n) {
    s.motor_v[joints[n]] = choose(used[n].slip * motor_v[n] < constant<T>(0.0), constant<T>(0.0), motor_v[n]);
    s.v[joints[n]] = v[n];
  }
  return settled;
}

template <bool kWorn, class T, class Time>
void advance_motors(const Plant<T>& plant, State<T>& s, const T (&volts)[kJoints], Time dt) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Joint<T>& joint = plant.joints[i];
    const Terms<T> terms = terms_of<kWorn>(joint, s, i, volts[i], dt);
    Sides<T> sides = first_guess<kWorn>(joint, terms, s, i, dt), used;
    T motor_v;
    bool settled = false;
    for (int pass = 0; pass < kPasses && !settled; ++pass) {
      used = sides;
      const Mesh<T> mesh = mesh_of<kWorn>(terms, used);
      motor_v = motor_velocity<kWorn>(terms, used, mesh, s.v[i]);
      settled = !any(settle<kWorn>(joint, terms, mesh, motor_v, s.v[i], dt, sides));
    }
    s.q[i] = s.q[i] + dt * s.v[i];
    s.motor_q[i] = s.motor_q[i] + dt * motor_v;
    s.motor_v[i] = choose(used.slip * motor_v < constant<T>(0.0), constant<T>(0.0), motor_v);
  }
}

template <bool kWorn, class T, class Time>
bool advance(const Plant<T>& plant, State<T>& s, const T (&volts)[kJoints], const T (&load)[kJoints], Time dt) {
  const Geometry<T> geometry = geometry_of(plant.body, pose_of<T>(s.q[1], s.q[2]));
  T bias[kJoints];
  bias_torque(geometry, s.v, bias);
  T momentum[kJoints];
  momentum_of(geometry.mass, s.v, momentum);
  for (std::size_t i = 0; i < kJoints; ++i) momentum[i] = momentum[i] + dt * (load[i] - bias[i]);
  const MassMatrix<T>& m = geometry.mass;
  const bool turned =
      advance_pair<kWorn>(plant, s, 0, 3, Links<T>{{m.m00, m.m33}, m.m03, {momentum[0], momentum[3]}}, volts, dt);
  const bool pitched =
      advance_pair<kWorn>(plant, s, 1, 2, Links<T>{{m.m11, m.m22}, m.m12, {momentum[1], momentum[2]}}, volts, dt);
  return turned && pitched;
}

}  // namespace detail

// Whether a joint has friction that grows with the load, or creep.
template <class T>
bool is_worn(const Plant<T>& plant) {
  bool worn = false;
  for (const Joint<T>& joint : plant.joints) {
    worn = worn || any(joint.friction.load != constant<T>(0.0)) || any(joint.friction.creep != constant<T>(0.0));
  }
  return worn;
}

// Advances the state by dt under motor voltages and torques applied to the links from outside. `worn` may be false only
// where `is_worn` is; this is then faster. dt may differ from lane to lane.
// Returns whether the conditions were settled; the links are within their stops either way.
template <class T, class Time>
bool advance(const Plant<T>& plant, State<T>& s, const T (&volts)[kJoints], const T (&load)[kJoints], Time dt,
             bool worn) {
  return worn ? detail::advance<true>(plant, s, volts, load, dt) : detail::advance<false>(plant, s, volts, load, dt);
}

// The motors alone, while something else moves the links at the velocities that they have.
template <class T, class Time>
void advance_motors(const Plant<T>& plant, State<T>& s, const T (&volts)[kJoints], Time dt, bool worn) {
  worn ? detail::advance_motors<true>(plant, s, volts, dt) : detail::advance_motors<false>(plant, s, volts, dt);
}

}  // namespace greywhale::arm
