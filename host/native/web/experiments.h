// Experiments that a page has added, and the buffers by which numbers go in and out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "closed_loop/batch.h"
#include "closed_loop/controllers.h"
#include "closed_loop/experiment.h"

#define EXPORT(name) __attribute__((export_name(#name)))

namespace greywhale::web {

using loop::kJoints;

extern std::vector<double> given, found;

// Reads what is given, in order.
class Reader {
 public:
  double next() { return given.at(at_++); }
  std::size_t size() { return static_cast<std::size_t>(next()); }
  std::size_t left() const { return given.size() - at_; }
  template <class T>
  void four(T (&to)[kJoints]) {
    for (T& value : to) value = static_cast<T>(next());
  }
  std::vector<double> some(std::size_t count) {
    at_ += count;
    return {given.end() - static_cast<std::ptrdiff_t>(left() + count),
            given.end() - static_cast<std::ptrdiff_t>(left())};
  }

  loop::Settings settings() {
    loop::Settings s{};
    s.period_ms = static_cast<int>(next());
    s.supply_mv = static_cast<std::uint16_t>(next());
    s.soft_start_ms = static_cast<std::uint16_t>(next());
    s.filter_shift = static_cast<int>(next());
    four(s.limit_min), four(s.limit_max), four(s.motor_sign), four(s.pwm_top);
    four(s.leader.zero), four(s.leader.scale), four(s.follower.zero), four(s.follower.scale);
    return s;
  }

  loop::Timing timing() {
    loop::Timing t{};
    t.start = static_cast<int>(next());
    four(t.acts);
    t.on = static_cast<int>(next());
    t.late = static_cast<int>(next());
    return t;
  }

  std::array<arm::Potentiometer, kJoints> pots() {
    std::array<arm::Potentiometer, kJoints> pots{};
    for (arm::Potentiometer& pot : pots) pot = {next(), next(), next(), next(), next(), {next(), next()}};
    return pots;
  }

 private:
  std::size_t at_ = 0;
};

// An experiment on some plants, and what the last candidates did there: each on every plant, one plant after the other.
struct Kept {
  loop::Experiment x{};
  std::vector<loop::PlantRow> plants;
  std::vector<std::int16_t> reference;
  std::vector<double> leader, weight;
  std::vector<float> noise;
  std::size_t count = 0;  // candidates times plants
  std::vector<double> mse, itae, itau;
  std::unique_ptr<bool[]> diverged;
  std::vector<float> angles;
  std::vector<std::int16_t> duties;
};
// By the number that a page has for it.
Kept& experiment_of(unsigned number);

// The rows of the candidates' controllers that are given, 4 x 13 each.
std::vector<std::int32_t> given_table();

// Simulates candidates. `exact`: in double precision.
void run(Kept& kept, const std::vector<std::int32_t>& table, bool exact);

}  // namespace greywhale::web
