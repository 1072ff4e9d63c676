// Mass matrix, velocity terms and gravity of the 4-DOF arm in corrected closed form (docs/arm.md derives it).
//
// Angles: q0 base yaw, q1 shoulder pitch, q2 wrist pitch, q3 wrist roll; phi = q1 + q2. Yaw and roll couple with each
// other and the two pitches with each other, never across, so the mass matrix is two 2x2 blocks. The number type may be
// double or lanes of either precision (scalar.h): the bench, the exact run, the windows and the batch have their
// equations from here.
#pragma once

#include "elementary.h"
#include "parameters.h"
#include "scalar.h"

namespace greywhale::arm {

// Everything the equations need of masses and lengths.
template <class T>
struct RigidBody {
  T yaw;                  // yaw inertia of link 0 about its own axis
  T ixx1, iyy1;           // link 1, iyy1 with the masses it carries
  T ixx23, iyy23, izz23;  // links 2 and 3 with the tip, about the wrist
  T ixx3;                 // roll inertia
  T izz1;                 // link 1 about the shoulder, with the masses it carries
  T coupling;             // L1 x first moment of links 2, 3 and tip
  T gravity1, gravity2;   // N m, gravity torque of shoulder and wrist at zero pitch
};

// Sines and cosines of one configuration.
template <class T>
struct Pose {
  T s1, c1, s2, c2, sphi, cphi;
};

template <class T>
struct MassMatrix {
  T m00, m03, m33;  // yaw and roll
  T m11, m12, m22;  // the pitches
};

// All that depends on the links' angles alone.
template <class T>
struct Geometry {
  MassMatrix<T> mass;
  T half_d1, half_d2;    // halves of dm00/dq1 and dm00/dq2
  T roll;                // dm03/dphi
  T wrist;               // -dm12/dq2
  T gravity1, gravity2;  // N m
};

// Link 3's inertias about y and z are averaged: with different values the matrix would depend on the roll angle and
// lose its block form.
inline RigidBody<double> rigid_body(const ArmParameters& p) {
  const Link& link1 = p.links[1];
  const Link& link2 = p.links[2];
  const Link& link3 = p.links[3];
  const double carried = link2.mass + link3.mass + p.tip_mass;
  const double reach3 = link2.length + link3.centre;
  const double reach_tip = link2.length + link3.length;
  const double first1 = link1.mass * link1.centre + carried * link1.length;
  const double first2 = link2.mass * link2.centre + link3.mass * reach3 + p.tip_mass * reach_tip;
  const double second1 = link1.mass * link1.centre * link1.centre + carried * link1.length * link1.length;
  const double second2 =
      link2.mass * link2.centre * link2.centre + link3.mass * reach3 * reach3 + p.tip_mass * reach_tip * reach_tip;
  const double across3 = 0.5 * (link3.iyy + link3.izz);

  RigidBody<double> body{};
  body.yaw = p.links[0].iyy;
  body.ixx1 = link1.ixx;
  body.iyy1 = link1.iyy + second1;
  body.izz1 = link1.izz + second1;
  body.ixx23 = link2.ixx + link3.ixx;
  body.iyy23 = link2.iyy + across3 + second2;
  body.izz23 = link2.izz + across3 + second2;
  body.ixx3 = link3.ixx;
  body.coupling = link1.length * first2;
  body.gravity1 = p.gravity * first1;
  body.gravity2 = p.gravity * first2;
  return body;
}

// Of angles in radians, or in another unit of which the number type knows sine and cosine.
template <class T, class Angle>
GREYWHALE_INLINE Pose<T> pose_of(Angle q1, Angle q2) {
  Pose<T> pose;
  sines_cosines(q1, q2, pose.s1, pose.c1, pose.s2, pose.c2);
  pose.sphi = pose.s1 * pose.c2 + pose.c1 * pose.s2;
  pose.cphi = pose.c1 * pose.c2 - pose.s1 * pose.s2;
  return pose;
}

template <class T>
GREYWHALE_INLINE Geometry<T> geometry_of(const RigidBody<T>& b, const Pose<T>& p) {
  const T reach = b.coupling * p.c1;
  const T folded = b.coupling * p.c2;
  const T half_across = (b.ixx23 - b.iyy23) * (p.sphi * p.cphi);
  Geometry<T> g;
  g.mass.m00 = b.yaw + b.ixx1 * (p.s1 * p.s1) + b.iyy1 * (p.c1 * p.c1) + b.ixx23 * (p.sphi * p.sphi) +
               b.iyy23 * (p.cphi * p.cphi) + (reach + reach) * p.cphi;
  g.mass.m03 = b.ixx3 * p.sphi;
  g.mass.m33 = b.ixx3;
  g.mass.m22 = b.izz23;
  g.mass.m12 = b.izz23 + folded;
  g.mass.m11 = b.izz1 + b.izz23 + (folded + folded);
  g.half_d2 = half_across - reach * p.sphi;
  g.half_d1 = (b.ixx1 - b.iyy1) * (p.s1 * p.c1) + half_across - b.coupling * (p.s1 * p.cphi + p.c1 * p.sphi);
  g.roll = b.ixx3 * p.cphi;
  g.wrist = b.coupling * p.s2;
  g.gravity2 = b.gravity2 * p.cphi;
  g.gravity1 = b.gravity1 * p.c1 + g.gravity2;
  return g;
}

// Coriolis, centrifugal and gravity torques: the torque that holds zero acceleration.
template <class T>
GREYWHALE_INLINE void bias_torque(const Geometry<T>& g, const T (&v)[kJoints], T (&torque)[kJoints]) {
  const T pitch_rate = v[1] + v[2];
  const T rolling = g.roll * v[0];
  const T gyroscopic = rolling * v[3];
  const T square = v[0] * v[0];
  const T half_turn = g.half_d1 * v[1] + g.half_d2 * v[2];
  torque[0] = (half_turn + half_turn) * v[0] + g.roll * pitch_rate * v[3];
  torque[1] = g.gravity1 - g.half_d1 * square - g.wrist * v[2] * (pitch_rate + v[1]) - gyroscopic;
  torque[2] = g.gravity2 - g.half_d2 * square + g.wrist * (v[1] * v[1]) - gyroscopic;
  torque[3] = rolling * pitch_rate;
}

// All sixteen entries, row by row.
inline void fill_matrix(const MassMatrix<double>& m, double* out) {
  const double full[] = {m.m00, 0, 0, m.m03, 0, m.m11, m.m12, 0, 0, m.m12, m.m22, 0, m.m03, 0, 0, m.m33};
  for (const double entry : full) *out++ = entry;
}

template <class T>
GREYWHALE_INLINE void momentum_of(const MassMatrix<T>& m, const T (&v)[kJoints], T (&momentum)[kJoints]) {
  momentum[0] = m.m00 * v[0] + m.m03 * v[3];
  momentum[1] = m.m11 * v[1] + m.m12 * v[2];
  momentum[2] = m.m12 * v[1] + m.m22 * v[2];
  momentum[3] = m.m03 * v[0] + m.m33 * v[3];
}

template <class T>
T kinetic_energy(const MassMatrix<T>& m, const T (&v)[kJoints]) {
  T momentum[kJoints];
  momentum_of(m, v, momentum);
  return 0.5 * (momentum[0] * v[0] + momentum[1] * v[1] + momentum[2] * v[2] + momentum[3] * v[3]);
}

// Zero with the arm stretched out level.
template <class T>
T potential_energy(const RigidBody<T>& b, const Pose<T>& p) {
  return b.gravity1 * p.s1 + b.gravity2 * p.sphi;
}

}  // namespace greywhale::arm
