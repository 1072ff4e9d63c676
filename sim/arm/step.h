// One integration step of arm, motors, gears, friction and stops.
//
// Each joint is two bodies: the motor side (rotor and gear train, reflected to the output shaft, with all dry friction) and the link side.
// The gear mesh between them is a spring and damper with a dead zone. Everything stiff is taken at the end of the step (implicit Euler
// in the velocities): damping, mesh, friction, stops. Velocity terms and gravity are taken at its start. Then the step is linear once it
// is known which teeth touch, which shafts slide and which stops hold, and those are found by trying: solve, correct, solve again.
// The mesh and friction conditions are monotone, so this ends, nearly always within two passes; a step that does not is counted.
//
// All of it works lane by lane when T is a vector type.
#pragma once

#include <cstddef>

#include "friction.h"
#include "parameters.h"
#include "rigid_body.h"
#include "scalar.h"

namespace greywhale::arm {

template <class T>
struct Plant {
  RigidBody<T> body;
  Joint<T> joints[kJoints];
};

template <class T>
struct State {
  T q[kJoints], v[kJoints];              // link side
  T motor_q[kJoints], motor_v[kJoints];  // motor side, at the output shaft
};

namespace detail {

constexpr int kPasses = 8;
constexpr double kRigid = 1e15;  // kg m^2: beside it every inertia of an arm vanishes in rounding

// Which of the conditions hold in one joint: -1, 0 or +1 each.
template <class T>
struct Sides {
  T mesh;   // teeth in contact: motor ahead (+1), behind (-1), apart (0)
  T slip;   // direction the motor side slides in, 0 at rest
  T stop;   // upper (+1) or lower (-1) stop holds
};

// One joint's constants over the step; impulses in N m s.
template <class T>
struct Terms {
  T inertia;        // motor side with its damping: J + dt d
  T impulse;        // motor side momentum with the motor's torque
  T friction;       // sliding now
  T breakaway;
  T push;           // of the mesh as it is now deflected, were there no gap
  T gap_push;       // what the half gap takes off it
  T mesh;           // mesh impulse per closing velocity
  T deflection;     // motor ahead of link, rad
  T mesh_inertia;   // mesh / (inertia + mesh) x inertia: how much of the motor the link feels through the mesh
  T share;          // mesh / (inertia + mesh)
};

template <class T>
struct Row {
  T diagonal, right;
};

template <class T>
Terms<T> terms_of(const Joint<T>& joint, const State<T>& s, std::size_t i, T volts, double dt) {
  Terms<T> t;
  t.inertia = joint.actuator.inertia + dt * joint.actuator.damping;
  t.impulse = joint.actuator.inertia * s.motor_v[i] + dt * joint.actuator.torque_per_volt * volts;
  t.friction = dt * friction_torque(joint.friction, s.motor_v[i]);
  t.breakaway = dt * joint.friction.breakaway;
  t.deflection = s.motor_q[i] - s.q[i];
  t.push = dt * joint.gear.stiffness * t.deflection;
  t.gap_push = dt * joint.gear.stiffness * joint.gear.half_gap;
  t.mesh = choose(joint.gear.stiffness > constant<T>(0.0), dt * (dt * joint.gear.stiffness + joint.gear.damping), constant<T>(kRigid));
  t.share = t.mesh / (t.inertia + t.mesh);
  t.mesh_inertia = t.share * t.inertia;
  return t;
}

// Where a joint stands before the step, taken on by its present velocities.
template <class T>
Sides<T> first_guess(const Joint<T>& joint, const State<T>& s, std::size_t i, double dt) {
  const T zero = constant<T>(0.0);
  const T one = constant<T>(1.0);
  const T ahead = s.motor_q[i] - s.q[i] + dt * (s.motor_v[i] - s.v[i]);
  Sides<T> side;
  side.mesh = choose(absolute(ahead) >= joint.gear.half_gap, choose(ahead < zero, -one, one), zero);
  side.slip = sign(s.motor_v[i]);
  side.stop = choose(s.q[i] >= joint.stops.max, one, choose(s.q[i] <= joint.stops.min, -one, zero));
  return side;
}

// What motor and mesh add to the link's equation: the motor velocity is eliminated.
template <class T>
Row<T> link_row(const Terms<T>& t, const Sides<T>& side) {
  const T zero = constant<T>(0.0);
  const T push = t.push - side.mesh * t.gap_push;
  const T sliding = push + t.share * (t.impulse - push - side.slip * t.friction);
  const auto touching = side.mesh != zero;
  const auto slides = side.slip != zero;
  Row<T> row;
  row.diagonal = choose(touching, choose(slides, t.mesh_inertia, t.mesh), zero);
  row.right = choose(touching, choose(slides, sliding, push), zero);
  return row;
}

// The motor's velocity once the link's is known.
template <class T>
T motor_velocity(const Terms<T>& t, const Sides<T>& side, T link_v) {
  const T zero = constant<T>(0.0);
  const auto touching = side.mesh != zero;
  const T alone = (t.impulse - side.slip * t.friction) / t.inertia;
  const T push = t.push - side.mesh * t.gap_push;
  const T through = (t.impulse - push - side.slip * t.friction) / (t.inertia + t.mesh) + t.share * link_v;
  return choose(side.slip != zero, choose(touching, through, alone), zero);
}

template <class T>
struct Pair {
  T first, second;
};

// Two coupled links; one whose stop holds has its velocity given instead.
template <class T>
Pair<T> solve_pair(Row<T> a, T coupling, Row<T> b, T stop_a, T stop_b, T given_a, T given_b) {
  const T zero = constant<T>(0.0);
  const T one = constant<T>(1.0);
  const auto held_a = stop_a != zero;
  const auto held_b = stop_b != zero;
  const T aa = choose(held_a, one, a.diagonal);
  const T ab = choose(held_a, zero, coupling);
  const T ar = choose(held_a, given_a, a.right);
  const T bb = choose(held_b, one, b.diagonal);
  const T ba = choose(held_b, zero, coupling);
  const T br = choose(held_b, given_b, b.right);
  const T scale = 1.0 / (aa * bb - ab * ba);
  return {(bb * ar - ab * br) * scale, (aa * br - ba * ar) * scale};
}

// The sides that agree with the velocities just found.
template <class T>
Sides<T> corrected(const Joint<T>& joint, const Terms<T>& t, const Sides<T>& side, T link_v, T link_q, T residual, double dt) {
  const T zero = constant<T>(0.0);
  const T one = constant<T>(1.0);
  const T motor_v = motor_velocity(t, side, link_v);
  const T closing = motor_v - link_v;
  Sides<T> next;

  // Teeth push and never pull; apart, they meet on the side where the gap would close and the mesh would push.
  const T push = t.push + t.mesh * closing;
  const T ahead = t.deflection + dt * closing;
  const auto pulls = side.mesh * push < t.gap_push;
  const T meeting = choose(ahead > joint.gear.half_gap, one, choose(-ahead > joint.gear.half_gap, -one, zero));
  const T meets = choose(meeting * push > t.gap_push, meeting, zero);
  const T mesh = choose(side.mesh != zero, choose(pulls, zero, side.mesh), meets);
  next.mesh = choose(joint.gear.half_gap > zero, mesh, side.mesh);

  // Sliding ends where it would reverse; rest ends where more than the breakaway torque is needed to keep it.
  const T mesh_push = choose(side.mesh != zero, push - side.mesh * t.gap_push, zero);
  const T needed = t.impulse - mesh_push;
  const T starts = choose(absolute(needed) > t.breakaway, sign(needed), zero);
  const T slides = choose(side.slip * motor_v < zero, zero, side.slip);
  next.slip = choose(side.slip != zero, slides, starts);

  // A stop holds a link that would pass it and lets go of one that pulls away.
  const T reached = link_q + dt * link_v;
  const T arrives = choose(reached > joint.stops.max, one, choose(reached < joint.stops.min, -one, zero));
  const T holds = choose(side.stop * residual > zero, zero, side.stop);
  next.stop = choose(side.stop != zero, holds, arrives);
  return next;
}

}  // namespace detail

// Advances the state by dt under motor voltages and torques applied to the links from outside.
// Returns whether the conditions were settled; the state is finite and consistent either way.
template <class T>
bool advance(const Plant<T>& plant, State<T>& s, const T (&volts)[kJoints], const T (&load)[kJoints], double dt) {
  using namespace detail;
  const T zero = constant<T>(0.0);
  const Pose<T> pose = pose_of(s.q[1], s.q[2]);
  const MassMatrix<T> m = mass_matrix(plant.body, pose);
  const T inertia[kJoints] = {m.m00, m.m11, m.m22, m.m33};
  T bias[kJoints];
  bias_torque(plant.body, pose, s.v, bias);
  T momentum[kJoints];
  momentum_of(m, s.v, momentum);

  Terms<T> terms[kJoints];
  Sides<T> sides[kJoints];
  T given[kJoints];
  for (std::size_t i = 0; i < kJoints; ++i) {
    terms[i] = terms_of(plant.joints[i], s, i, volts[i], dt);
    sides[i] = first_guess(plant.joints[i], s, i, dt);
    momentum[i] = momentum[i] + dt * (load[i] - bias[i]);
  }

  T v[kJoints];
  bool settled = false;
  for (int pass = 0; pass < kPasses && !settled; ++pass) {
    Row<T> rows[kJoints];
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Row<T> added = link_row(terms[i], sides[i]);
      rows[i] = {inertia[i] + added.diagonal, momentum[i] + added.right};
      const Stops<T>& stops = plant.joints[i].stops;
      given[i] = (choose(sides[i].stop > zero, stops.max, stops.min) - s.q[i]) / dt;
    }
    const Pair<T> outer = solve_pair(rows[0], m.m03, rows[3], sides[0].stop, sides[3].stop, given[0], given[3]);
    const Pair<T> pitch = solve_pair(rows[1], m.m12, rows[2], sides[1].stop, sides[2].stop, given[1], given[2]);
    v[0] = outer.first;
    v[1] = pitch.first;
    v[2] = pitch.second;
    v[3] = outer.second;
    // What each stop must supply to keep its link's given velocity.
    const T residual[kJoints] = {rows[0].diagonal * v[0] + m.m03 * v[3] - rows[0].right, rows[1].diagonal * v[1] + m.m12 * v[2] - rows[1].right,
                                 m.m12 * v[1] + rows[2].diagonal * v[2] - rows[2].right, m.m03 * v[0] + rows[3].diagonal * v[3] - rows[3].right};
    bool changed = false;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Sides<T> next = corrected(plant.joints[i], terms[i], sides[i], v[i], s.q[i], residual[i], dt);
      changed = changed || any(next.mesh != sides[i].mesh) || any(next.slip != sides[i].slip) || any(next.stop != sides[i].stop);
      if (pass + 1 < kPasses) sides[i] = next;
    }
    settled = !changed;
  }

  for (std::size_t i = 0; i < kJoints; ++i) {
    const Stops<T>& stops = plant.joints[i].stops;
    s.motor_v[i] = motor_velocity(terms[i], sides[i], v[i]);
    s.motor_q[i] = s.motor_q[i] + dt * s.motor_v[i];
    const T reached = s.q[i] + dt * v[i];
    s.q[i] = choose(reached > stops.max, stops.max, choose(reached < stops.min, stops.min, reached));
    s.v[i] = choose(sides[i].stop != zero, zero, v[i]);  // inelastic: what was left of its velocity is gone
  }
  return settled;
}

}  // namespace greywhale::arm
