// The links' equations of one step: two pairs of coupled joints, yaw with roll and shoulder with wrist.
#pragma once

#include "conditions.h"
#include "rigid_body.h"
#include "scalar.h"

namespace greywhale::arm {

template <class T>
struct LinearSystem {
  Row<T> rows[kJoints];
  T coupling03, coupling12;
};

template <bool kWorn, class T>
LinearSystem<T> linear_system(const MassMatrix<T>& m, const T (&momentum)[kJoints], const Terms<T> (&terms)[kJoints],
                              const Sides<T> (&sides)[kJoints]) {
  const T inertia[kJoints] = {m.m00, m.m11, m.m22, m.m33};
  LinearSystem<T> system;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Row<T> added = link_row<kWorn>(terms[i], sides[i]);
    system.rows[i] = {inertia[i] + added.diagonal, momentum[i] + added.right};
  }
  system.coupling03 = m.m03;
  system.coupling12 = m.m12;
  return system;
}

// One pair, by Cramer's rule; a link that its stop holds has its velocity given instead.
template <class T>
void solve_pair(const LinearSystem<T>& system, T coupling, std::size_t i, std::size_t j,
                const Sides<T> (&sides)[kJoints], const T (&given)[kJoints], T (&v)[kJoints]) {
  const T zero = constant<T>(0.0);
  const T one = constant<T>(1.0);
  const auto held_i = sides[i].stop != zero;
  const auto held_j = sides[j].stop != zero;
  const T ii = choose(held_i, one, system.rows[i].diagonal);
  const T ij = choose(held_i, zero, coupling);
  const T ir = choose(held_i, given[i], system.rows[i].right);
  const T jj = choose(held_j, one, system.rows[j].diagonal);
  const T ji = choose(held_j, zero, coupling);
  const T jr = choose(held_j, given[j], system.rows[j].right);
  const T scale = 1.0 / (ii * jj - ij * ji);
  v[i] = (jj * ir - ij * jr) * scale;
  v[j] = (ii * jr - ji * ir) * scale;
}

template <class T>
void solve(const LinearSystem<T>& system, const Sides<T> (&sides)[kJoints], const T (&given)[kJoints],
           T (&v)[kJoints]) {
  solve_pair(system, system.coupling03, 0, 3, sides, given, v);
  solve_pair(system, system.coupling12, 1, 2, sides, given, v);
}

// The impulse each stop must supply to keep its link's given velocity.
template <class T>
void stop_impulses(const LinearSystem<T>& system, const T (&v)[kJoints], T (&impulse)[kJoints]) {
  const Row<T>(&r)[kJoints] = system.rows;
  impulse[0] = r[0].diagonal * v[0] + system.coupling03 * v[3] - r[0].right;
  impulse[1] = r[1].diagonal * v[1] + system.coupling12 * v[2] - r[1].right;
  impulse[2] = system.coupling12 * v[1] + r[2].diagonal * v[2] - r[2].right;
  impulse[3] = system.coupling03 * v[0] + r[3].diagonal * v[3] - r[3].right;
}

}  // namespace greywhale::arm
