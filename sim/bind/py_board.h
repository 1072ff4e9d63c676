// A simulated board as Python has it.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "board/board.h"

namespace greywhale::bind {

namespace nb = nanobind;

// A Board with the array that outputs() returns each time.
class PyBoard : public board::Board {
 public:
  using Millivolts = nb::ndarray<const double, nb::shape<board::Adc::input_count>, nb::c_contig, nb::device::cpu>;
  using Board::Board;

  nb::object outputs() {
    if (!values_ || size_ != output_count()) {
      size_ = output_count();
      values_ = new double[size_];
      nb::capsule owner(values_, [](void* values) noexcept { delete[] static_cast<double*>(values); });
      array_ = nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>>(values_, {size_}, owner));
    }
    read_outputs(values_);
    return array_;
  }

  int run(uint64_t until) {
    // Letting other threads run is worth its cost for long runs only; the bench makes thousands of short ones.
    constexpr uint64_t long_run = 1000000;
    if (until < cycle() + long_run) return static_cast<int>(run_until(until));
    nb::gil_scoped_release release;
    return static_cast<int>(run_until(until));
  }

  void set_millivolts(const Millivolts& values) {
    std::array<double, board::Adc::input_count> millivolts;
    std::copy_n(values.data(), millivolts.size(), millivolts.begin());
    adc().set_millivolts(millivolts);
  }

 private:
  double* values_ = nullptr;  // owned by array_
  size_t size_ = 0;
  nb::object array_;
};

}  // namespace greywhale::bind
