// Binds the links' equations for many states at a time; RigidBody (arm.cpp) is the same for one.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "arm/columns.h"
#include "arm/rigid_body.h"
#include "bindings.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace arm = greywhale::arm;

namespace {

using arm::kJoints;
using Four = double[kJoints];

template <class... Shape>
using In = nb::ndarray<const double, Shape..., nb::c_contig, nb::device::cpu>;
using Columns = In<nb::shape<std::size(arm::kBodyColumns)>>;
using Rows = In<nb::shape<-1, kJoints>>;
template <class... Shape>
using Out = nb::ndarray<nb::numpy, double, Shape..., nb::c_contig>;
using Matrices = Out<nb::shape<-1, kJoints, kJoints>>;
using Torques = Out<nb::shape<-1, kJoints>>;

arm::RigidBody<double> body_of(const Columns& columns) {
  arm::RigidBody<double> body;
  std::copy_n(columns.data(), columns.size(), reinterpret_cast<double*>(&body));
  return body;
}

nb::capsule owner_of(double* values) {
  return nb::capsule(values, [](void* p) noexcept { delete[] static_cast<double*>(p); });
}

Matrices mass_matrix(const Columns& columns, const Rows& q) {
  const arm::RigidBody<double> body = body_of(columns);
  const std::size_t count = q.shape(0);
  auto values = std::make_unique<double[]>(count * kJoints * kJoints);
  for (std::size_t n = 0; n < count; ++n) {
    const arm::Geometry<double> geometry = arm::geometry_of(body, arm::pose_of<double>(q(n, 1), q(n, 2)));
    arm::fill_matrix(geometry.mass, &values[n * kJoints * kJoints]);
  }
  double* raw = values.release();
  return Matrices(raw, {count, kJoints, kJoints}, owner_of(raw));
}

Torques bias(const Columns& columns, const Rows& q, const Rows& v) {
  if (q.shape(0) != v.shape(0)) throw std::invalid_argument("q and v differ in length.");
  const arm::RigidBody<double> body = body_of(columns);
  const std::size_t count = q.shape(0);
  auto values = std::make_unique<double[]>(count * kJoints);
  for (std::size_t n = 0; n < count; ++n) {
    Four speed, torque;
    std::copy_n(&v(n, 0), kJoints, speed);
    arm::bias_torque(arm::geometry_of(body, arm::pose_of<double>(q(n, 1), q(n, 2))), speed, torque);
    std::copy_n(torque, kJoints, &values[n * kJoints]);
  }
  double* raw = values.release();
  return Torques(raw, {count, kJoints}, owner_of(raw));
}

}  // namespace

void bind_rigid_body(nb::module_& m) {
  m.def("rigid_body_mass_matrix", &mass_matrix, "body"_a, "q"_a,
        "Mass matrices (n, 4, 4), kg m^2, at angles (n, 4), rad. `body` (11,) is what a plant begins with.");
  m.def("rigid_body_bias", &bias, "body"_a, "q"_a, "v"_a,
        "Velocity and gravity torques (n, 4), N m, at angles and speeds (n, 4), rad and rad/s: what holds zero "
        "acceleration.");
}
