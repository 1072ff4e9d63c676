// One integration step of links, motors, gears, friction and stops.
//
// Each joint is two bodies: the motor side (rotor and gear train, reflected to the output shaft, with all dry friction)
// and the link side. The gear mesh between them is a spring and damper with a dead zone. Everything stiff is taken at
// the end of the step (implicit Euler in the velocities): motor damping, mesh, friction, stops. Velocity terms and
// gravity are taken at its start. The step is linear once it is known which teeth touch, which shafts slide and which
// stops hold, and that is found by trying: solve, correct, solve again. The conditions are monotone, so this ends,
// nearly always within two passes; a step that does not settle is counted. All of it works lane by lane when T is a
// vector type.
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

// Corrects all sides by the velocities found with them; true when nothing changed.
template <bool kWorn, class T, class Time>
bool settle(const Plant<T>& plant, const State<T>& s, const Terms<T> (&terms)[kJoints], const LinearSystem<T>& system,
            const T (&v)[kJoints], Time dt, Sides<T> (&sides)[kJoints]) {
  T impulses[kJoints];
  stop_impulses(system, v, impulses);
  bool settled = true;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Joint<T>& joint = plant.joints[i];
    const Sides<T> side = sides[i];
    const T motor_v = motor_velocity<kWorn>(terms[i], side, v[i]);
    const T closing = motor_v - v[i];
    sides[i].mesh = corrected_mesh(joint.gear, terms[i], side.mesh, closing, dt);
    if (kWorn) {
      const T passed = passed_impulse(terms[i], side, motor_v, v[i]);
      sides[i].mesh = corrected_gapless(joint.gear, terms[i], sides[i].mesh, passed);
      sides[i].slip = corrected_worn_slip(joint.friction, terms[i], side, motor_v, passed);
    } else {
      sides[i].slip = corrected_slip(terms[i], side, motor_v, closing);
    }
    sides[i].stop = corrected_stop(joint.stops, side.stop, s.q[i] + dt * v[i], impulses[i]);
    const bool changed =
        any(sides[i].mesh != side.mesh) || any(sides[i].slip != side.slip) || any(sides[i].stop != side.stop);
    settled = settled && !changed;
  }
  return settled;
}

// Impact is inelastic: a link is at rest when it has arrived at its stop, and its neighbour feels all of that blow.
template <class T>
void rest_at_stops(const LinearSystem<T>& system, const Sides<T> (&sides)[kJoints], T (&v)[kJoints]) {
  const T zero = constant<T>(0.0);
  const T rest[kJoints] = {zero, zero, zero, zero};
  if (any(sides[0].stop != zero) || any(sides[1].stop != zero) || any(sides[2].stop != zero) ||
      any(sides[3].stop != zero)) {
    solve(system, sides, rest, v);
  }
}

template <bool kWorn, class T, class Time>
bool advance(const Plant<T>& plant, State<T>& s, const T (&volts)[kJoints], const T (&load)[kJoints], Time dt) {
  const Geometry<T> geometry = geometry_of(plant.body, pose_of<T>(s.q[1], s.q[2]));
  T bias[kJoints];
  bias_torque(geometry, s.v, bias);
  T momentum[kJoints];
  momentum_of(geometry.mass, s.v, momentum);

  Terms<T> terms[kJoints];
  Sides<T> sides[kJoints];
  for (std::size_t i = 0; i < kJoints; ++i) {
    terms[i] = terms_of<kWorn>(plant.joints[i], s, i, volts[i], dt);
    sides[i] = first_guess(plant.joints[i], s, i, dt);
    momentum[i] = momentum[i] + dt * (load[i] - bias[i]);
  }

  LinearSystem<T> system;
  Sides<T> used[kJoints];
  T v[kJoints];
  bool settled = false;
  for (int pass = 0; pass < kPasses && !settled; ++pass) {
    system = linear_system<kWorn>(geometry.mass, momentum, terms, sides);
    T arriving[kJoints];  // at its stop exactly at the end of the step
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Stops<T>& stops = plant.joints[i].stops;
      arriving[i] = (choose(sides[i].stop > constant<T>(0.0), stops.max, stops.min) - s.q[i]) / dt;
      used[i] = sides[i];
    }
    solve(system, used, arriving, v);
    settled = detail::settle<kWorn>(plant, s, terms, system, v, dt, sides);
  }

  for (std::size_t i = 0; i < kJoints; ++i) {
    const Stops<T>& stops = plant.joints[i].stops;
    const T reached = s.q[i] + dt * v[i];
    s.q[i] = choose(reached > stops.max, stops.max, choose(reached < stops.min, stops.min, reached));
    s.motor_q[i] = s.motor_q[i] + dt * motor_velocity<kWorn>(terms[i], used[i], v[i]);
  }
  detail::rest_at_stops(system, used, v);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const T motor_v = motor_velocity<kWorn>(terms[i], used[i], v[i]);
    s.motor_v[i] = choose(used[i].slip * motor_v < constant<T>(0.0), constant<T>(0.0), motor_v);
    s.v[i] = v[i];
  }
  return settled;
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

}  // namespace greywhale::arm
