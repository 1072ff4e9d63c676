// Four numbers, one for each joint, between numpy and C++.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/variant.h>

#include <array>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <variant>

#include "arm/parameters.h"

namespace greywhale::bind {

namespace nb = nanobind;

using Four = double[arm::kJoints];
using InArray = nb::ndarray<const double, nb::shape<arm::kJoints>, nb::c_contig, nb::device::cpu>;
using In = std::variant<InArray, std::array<double, arm::kJoints>>;  // numpy, or any sequence of four numbers
using Out = nb::ndarray<nb::numpy, double, nb::shape<arm::kJoints>, nb::c_contig>;

// A copy of an argument, so that its memory need not outlive the call.
struct Copy {
  explicit Copy(const In& in) {
    std::visit([this](const auto& four) { std::memcpy(values, four.data(), sizeof values); }, in);
  }
  std::array<double, arm::kJoints> array() const { return {values[0], values[1], values[2], values[3]}; }
  Four values;
};

template <class Result, std::size_t N>
Result owned(const double (&values)[N], std::initializer_list<std::size_t> shape) {
  auto copy = std::make_unique<double[]>(N);
  std::memcpy(copy.get(), values, sizeof values);
  nb::capsule owner(copy.get(), [](void* p) noexcept { delete[] static_cast<double*>(p); });
  return Result(copy.release(), shape, owner);
}

inline Out array_of(const Four& values) { return owned<Out>(values, {arm::kJoints}); }

inline Out array_of(const std::array<double, arm::kJoints>& values) {
  return array_of({values[0], values[1], values[2], values[3]});
}

}  // namespace greywhale::bind
