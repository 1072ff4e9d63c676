// What can change from step to step in a joint: which teeth touch, whether the motor side slides, whether a stop holds.
//
// With these sides chosen, motor, mesh and friction are linear in the velocities at the end of the step. The motor's
// velocity is eliminated, so that the link's equation alone remains; `corrected` then says which sides those velocities
// really ask for.
//
// `kWorn` is whether there is friction that grows with the load, or creep. Without them the numbers are the same bits,
// in less time.
#pragma once

#include <cstddef>

#include "friction.h"
#include "parameters.h"
#include "scalar.h"

namespace greywhale::arm {

template <class T>
struct State {
  T q[kJoints], v[kJoints];              // link side
  T motor_q[kJoints], motor_v[kJoints];  // motor side, at the output shaft
};

// -1, 0 or +1 each.
template <class T>
struct Sides {
  T mesh;  // teeth in contact: motor ahead (+1), behind (-1), apart (0)
  T slip;  // direction the motor side slides in, 0 at rest
  T stop;  // upper (+1) or lower (-1) stop holds the link
};

// One joint's constants over the step. Impulses in N m s; an "inertia" here is an impulse per velocity.
template <class T>
struct Terms {
  T inertia;   // motor side with its damping over the step
  T impulse;   // motor side momentum with the motor's torque
  T friction;  // while sliding at the present speed
  T breakaway;
  T deflection;  // motor ahead of link, rad
  T push;        // of the mesh as it is now deflected, were there no gap
  T gap_push;    // what the half gap takes off it
  T mesh;        // impulse of touching teeth per closing velocity
  T drag;        // the same of the grease, which works all the time
  T load;        // share of the mesh's impulse that friction adds
  T creeps;      // 1 where a side at rest gives way a little, else 0
  T creep;       // friction per velocity of one that does
};

// What motor and mesh do for one choice of sides.
template <class T>
struct Mesh {
  T push, stiff;  // impulse from its present deflection, and per closing velocity
  T inertia;      // of the motor side, with what its creep resists by
  T felt;         // share of the mesh's impulse that the motor side feels: friction grows with it
  T total;        // impulse per velocity of a motor side that moves
  T share;        // of the link's velocity that a moving motor side takes on, per `felt`
  T driven;       // impulse on the motor side, without the mesh's part that depends on velocities
};

// One row of the links' equations: what motor and mesh add to it.
template <class T>
struct Row {
  T diagonal, right;
};

// kg m^2; beside it every inertia of an arm vanishes in rounding, which is what makes a rigid gear rigid.
constexpr double kRigid = 1e15;

// N m s; a pull below it is rounding and lets nothing go, so that a side that neither pushes nor pulls is not chosen in
// turns.
constexpr double kNoPull = 1e-14;

template <bool kWorn, class T, class Time>
GREYWHALE_INLINE Terms<T> terms_of(const Joint<T>& joint, const State<T>& s, std::size_t i, T volts, Time dt) {
  const Gear<T>& gear = joint.gear;
  const T compliant = dt * (dt * gear.stiffness + gear.damping);
  Terms<T> t;
  t.inertia = joint.actuator.inertia + dt * joint.actuator.damping;
  t.impulse = joint.actuator.inertia * s.motor_v[i] + dt * joint.actuator.torque_per_volt * volts;
  t.friction = dt * friction_torque(joint.friction, s.motor_v[i]);
  t.breakaway = dt * joint.friction.breakaway;
  t.deflection = s.motor_q[i] - s.q[i];
  t.push = dt * gear.stiffness * t.deflection;
  t.gap_push = dt * gear.stiffness * gear.half_gap;
  t.mesh = choose(gear.stiffness > constant<T>(0.0), compliant, constant<T>(kRigid));
  t.drag = dt * gear.drag;
  if (kWorn) {
    const T zero = constant<T>(0.0), one = constant<T>(1.0);
    const T creeping = choose(t.breakaway > zero, joint.friction.creep, zero);
    t.load = joint.friction.load;
    t.creeps = choose(creeping > zero, one, zero);
    t.creep = t.breakaway / choose(creeping > zero, creeping, one);
  }
  return t;
}

// Not 0 where the motor side moves: while it slides, and at rest where it creeps.
template <bool kWorn, class T>
GREYWHALE_INLINE T moving(const Terms<T>& t, const Sides<T>& side) {
  return kWorn ? choose(side.slip != constant<T>(0.0), side.slip, t.creeps) : side.slip;
}

template <bool kWorn, class T>
GREYWHALE_INLINE Mesh<T> mesh_of(const Terms<T>& t, const Sides<T>& side) {
  const T zero = constant<T>(0.0);
  const auto touching = side.mesh != zero;
  Mesh<T> mesh;
  mesh.push = choose(touching, t.push - side.mesh * t.gap_push, zero);
  mesh.stiff = choose(touching, t.mesh + t.drag, t.drag);
  mesh.inertia = t.inertia;
  T felt = mesh.stiff, push = mesh.push;
  if (kWorn) {
    mesh.felt = side.slip * side.mesh * t.load + 1.0;
    mesh.inertia = choose(side.slip != zero, t.inertia, t.inertia + t.creep);
    felt = mesh.felt * mesh.stiff;
    push = mesh.felt * mesh.push;
  }
  mesh.total = mesh.inertia + felt;
  mesh.share = mesh.stiff / mesh.total;
  mesh.driven = t.impulse - push - side.slip * t.friction;
  return mesh;
}

// Where a joint stands before the step, taken on by its present velocities. A shaft that slides goes on unless friction
// stops it on the way; one that rests starts where more than its breakaway torque is needed to keep it.
template <bool kWorn, class T, class Time>
GREYWHALE_INLINE Sides<T> first_guess(const Joint<T>& joint, const Terms<T>& t, const State<T>& s, std::size_t i,
                                      Time dt) {
  const T zero = constant<T>(0.0);
  const T one = constant<T>(1.0);
  const T ahead = t.deflection + dt * (s.motor_v[i] - s.v[i]);
  Sides<T> side;
  side.mesh = choose(absolute(ahead) >= joint.gear.half_gap, choose(ahead < zero, -one, one), zero);
  side.stop = choose(s.q[i] >= joint.stops.max, one, choose(s.q[i] <= joint.stops.min, -one, zero));
  const auto touching = side.mesh != zero;
  const T push = choose(touching, t.push - side.mesh * t.gap_push, zero);
  const T passed = push - choose(touching, t.mesh + t.drag, t.drag) * s.v[i];
  const T needed = t.impulse - passed;
  T friction = t.friction, breakaway = t.breakaway;
  if (kWorn) {
    const T more = t.load * absolute(passed);
    friction = friction + more;
    breakaway = breakaway + more;
  }
  const T slides = choose(absolute(s.motor_v[i]) > joint.friction.creep, sign(s.motor_v[i]), zero);
  const T starts = choose(absolute(needed) > breakaway, sign(needed), zero);
  side.slip = choose(slides * needed > absolute(slides) * friction, slides, starts);
  return side;
}

// A motor side at rest holds the link through the mesh alone; a moving one goes with it by `share`.
template <bool kWorn, class T>
GREYWHALE_INLINE Row<T> link_row(const Terms<T>& t, const Sides<T>& side, const Mesh<T>& mesh) {
  const auto moves = moving<kWorn>(t, side) != constant<T>(0.0);
  Row<T> row;
  row.diagonal = choose(moves, mesh.share * mesh.inertia, mesh.stiff);
  row.right = choose(moves, mesh.push + mesh.share * mesh.driven, mesh.push);
  return row;
}

template <bool kWorn, class T>
GREYWHALE_INLINE T motor_velocity(const Terms<T>& t, const Sides<T>& side, const Mesh<T>& mesh, T link_v) {
  const auto moves = moving<kWorn>(t, side) != constant<T>(0.0);
  const T share = kWorn ? mesh.felt * mesh.share : mesh.share;
  return choose(moves, mesh.driven / mesh.total + share * link_v, constant<T>(0.0));
}

// What the mesh passes on over the step; taken from what is left of the motor's own impulse where it moves, since a
// rigid mesh shows nothing.
template <class T>
GREYWHALE_INLINE T passed_impulse(const Terms<T>& t, const Sides<T>& side, const Mesh<T>& mesh, T motor_v, T link_v) {
  const auto moves = moving<true>(t, side) != constant<T>(0.0);
  const T left = t.impulse - side.slip * t.friction - mesh.inertia * motor_v;
  return choose(moves, left / mesh.felt, mesh.push - mesh.stiff * link_v);
}

// Teeth push and never pull. Apart, they meet on the side where the gap would close and the mesh would push.
template <class T, class Time>
GREYWHALE_INLINE T corrected_mesh(const Gear<T>& gear, const Terms<T>& t, T side, T closing, Time dt) {
  const T zero = constant<T>(0.0);
  const T one = constant<T>(1.0);
  const T push = t.push + t.mesh * closing;
  const T ahead = t.deflection + dt * closing;
  const T meeting = choose(ahead > gear.half_gap, one, choose(-ahead > gear.half_gap, -one, zero));
  const T meets = choose(meeting * push > t.gap_push, meeting, zero);
  const T stays = choose(side * push < t.gap_push - kNoPull, zero, side);
  return choose(gear.half_gap > zero, choose(side != zero, stays, meets), side);
}

// Where there is no gap, the side says which way the mesh pushes; only friction that grows with the load asks for it.
template <class T>
GREYWHALE_INLINE T corrected_gapless(const Gear<T>& gear, const Terms<T>& t, T side, T passed) {
  const T zero = constant<T>(0.0);
  const T turned = choose(side * passed < constant<T>(-kNoPull), -side, side);
  return choose(t.load > zero, choose(gear.half_gap > zero, side, turned), side);
}

// Sliding ends where it would reverse; rest ends where more than the breakaway torque is needed to keep it.
template <class T>
GREYWHALE_INLINE T corrected_slip(const Terms<T>& t, const Sides<T>& side, const Mesh<T>& mesh, T motor_v, T closing) {
  const T zero = constant<T>(0.0);
  const T needed = t.impulse - mesh.push - mesh.stiff * closing;
  const T starts = choose(absolute(needed) > t.breakaway, sign(needed), zero);
  const T stays = choose(side.slip * motor_v < zero, zero, side.slip);
  return choose(side.slip != zero, stays, starts);
}

// The same with friction that grows with the load. Sliding also ends where it gets as slow as creep.
template <class T>
GREYWHALE_INLINE T corrected_worn_slip(const Friction<T>& friction, const Terms<T>& t, const Sides<T>& side, T motor_v,
                                       T passed) {
  const T zero = constant<T>(0.0);
  const T needed = t.impulse - passed - t.inertia * motor_v;
  const T starts = choose(absolute(needed) > t.breakaway + t.load * absolute(passed), sign(needed), zero);
  const T stays = choose(side.slip * motor_v < friction.creep, zero, side.slip);
  return choose(side.slip != zero, stays, starts);
}

// A stop holds a link that would pass it and lets go of one that it would have to pull, unless there is no room to go.
template <class T>
GREYWHALE_INLINE T corrected_stop(const Stops<T>& stops, T side, T reached, T stop_impulse) {
  const T zero = constant<T>(0.0);
  const T one = constant<T>(1.0);
  const T arrives = choose(reached > stops.max, one, choose(reached < stops.min, -one, zero));
  const T stays = choose(side * stop_impulse > constant<T>(kNoPull), zero, side);
  return choose(side != zero, choose(stops.max > stops.min, stays, side), arrives);
}

}  // namespace greywhale::arm
