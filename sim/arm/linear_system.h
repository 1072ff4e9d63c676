// The links' equations of one step for a pair of coupled joints: yaw with roll, or shoulder with wrist.
#pragma once

#include "conditions.h"
#include "rigid_body.h"
#include "scalar.h"

namespace greywhale::arm {

template <class T>
struct LinearSystem {
  Row<T> rows[2];
  T coupling;
};

template <bool kWorn, class T>
GREYWHALE_INLINE LinearSystem<T> linear_system(const T (&inertia)[2], T coupling, const T (&momentum)[2],
                                               const Terms<T> (&terms)[2], const Sides<T> (&sides)[2],
                                               const Mesh<T> (&meshes)[2]) {
  LinearSystem<T> system;
  for (std::size_t n = 0; n < 2; ++n) {
    const Row<T> added = link_row<kWorn>(terms[n], sides[n], meshes[n]);
    system.rows[n] = {inertia[n] + added.diagonal, momentum[n] + added.right};
  }
  system.coupling = coupling;
  return system;
}

// By Cramer's rule.
template <class T>
GREYWHALE_INLINE void solve_free(const LinearSystem<T>& system, T (&v)[2]) {
  const Row<T>&a = system.rows[0], &b = system.rows[1];
  const T scale = 1.0 / (a.diagonal * b.diagonal - system.coupling * system.coupling);
  v[0] = (b.diagonal * a.right - system.coupling * b.right) * scale;
  v[1] = (a.diagonal * b.right - system.coupling * a.right) * scale;
}

// The same where a stop may hold a link: it has its velocity given instead.
template <class T>
void solve(const LinearSystem<T>& system, const Sides<T> (&sides)[2], const T (&given)[2], T (&v)[2]) {
  const T zero = constant<T>(0.0);
  const T one = constant<T>(1.0);
  const auto held_i = sides[0].stop != zero;
  const auto held_j = sides[1].stop != zero;
  const T ii = choose(held_i, one, system.rows[0].diagonal);
  const T ij = choose(held_i, zero, system.coupling);
  const T ir = choose(held_i, given[0], system.rows[0].right);
  const T jj = choose(held_j, one, system.rows[1].diagonal);
  const T ji = choose(held_j, zero, system.coupling);
  const T jr = choose(held_j, given[1], system.rows[1].right);
  const T scale = 1.0 / (ii * jj - ij * ji);
  v[0] = (jj * ir - ij * jr) * scale;
  v[1] = (ii * jr - ji * ir) * scale;
}

// The impulse each stop must supply to keep its link's given velocity.
template <class T>
void stop_impulses(const LinearSystem<T>& system, const T (&v)[2], T (&impulse)[2]) {
  const Row<T>(&r)[2] = system.rows;
  impulse[0] = r[0].diagonal * v[0] + system.coupling * v[1] - r[0].right;
  impulse[1] = system.coupling * v[0] + r[1].diagonal * v[1] - r[1].right;
}

}  // namespace greywhale::arm
