// The arm as a row of numbers: the name of each, in the order of the members.
#pragma once

#include <cstddef>

#include "parameters.h"
#include "rigid_body.h"

namespace greywhale::arm {

struct Column {
  const char* name;
  std::size_t offset;  // of the member, bytes
};

namespace detail {
using Body = RigidBody<double>;
using Shaft = Joint<double>;

// Whether a record is nothing but its columns, all of them and in this order.
template <class Record, std::size_t N>
constexpr bool is_all_of(const Column (&columns)[N]) {
  for (std::size_t n = 0; n < N; ++n) {
    if (columns[n].offset != n * sizeof(double)) return false;
  }
  return sizeof(Record) == N * sizeof(double);
}
}  // namespace detail

// Of RigidBody.
constexpr Column kBodyColumns[] = {
    {"yaw", offsetof(detail::Body, yaw)},           {"ixx1", offsetof(detail::Body, ixx1)},
    {"iyy1", offsetof(detail::Body, iyy1)},         {"ixx23", offsetof(detail::Body, ixx23)},
    {"iyy23", offsetof(detail::Body, iyy23)},       {"izz23", offsetof(detail::Body, izz23)},
    {"ixx3", offsetof(detail::Body, ixx3)},         {"izz1", offsetof(detail::Body, izz1)},
    {"coupling", offsetof(detail::Body, coupling)}, {"gravity1", offsetof(detail::Body, gravity1)},
    {"gravity2", offsetof(detail::Body, gravity2)},
};
static_assert(detail::is_all_of<detail::Body>(kBodyColumns), "RigidBody and the names of its columns differ");

// Of Joint.
constexpr Column kJointColumns[] = {
    {"torque_per_volt", offsetof(detail::Shaft, actuator.torque_per_volt)},
    {"inertia", offsetof(detail::Shaft, actuator.inertia)},
    {"damping", offsetof(detail::Shaft, actuator.damping)},
    {"resistance", offsetof(detail::Shaft, actuator.resistance)},
    {"coulomb", offsetof(detail::Shaft, friction.coulomb)},
    {"breakaway", offsetof(detail::Shaft, friction.breakaway)},
    {"stribeck_velocity", offsetof(detail::Shaft, friction.stribeck_velocity)},
    {"load_friction", offsetof(detail::Shaft, friction.load)},
    {"creep_velocity", offsetof(detail::Shaft, friction.creep)},
    {"half_gap", offsetof(detail::Shaft, gear.half_gap)},
    {"stiffness", offsetof(detail::Shaft, gear.stiffness)},
    {"mesh_damping", offsetof(detail::Shaft, gear.damping)},
    {"drag", offsetof(detail::Shaft, gear.drag)},
    {"stop_min", offsetof(detail::Shaft, stops.min)},
    {"stop_max", offsetof(detail::Shaft, stops.max)},
    {"pot_play", offsetof(detail::Shaft, sensor.play)},
    {"pot_lag", offsetof(detail::Shaft, sensor.lag)},
    {"lost_up", offsetof(detail::Shaft, driver.lost_up)},
    {"lost_down", offsetof(detail::Shaft, driver.lost_down)},
};
static_assert(detail::is_all_of<detail::Shaft>(kJointColumns), "Joint and the names of its columns differ");

}  // namespace greywhale::arm
