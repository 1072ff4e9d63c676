// Binds firmware/lib/fuzzy_pdi: the firmware's own arithmetic, one value or whole arrays at a time. greywhale.fuzzy
// wraps it.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bindings.h"
#include "fuzzy_pdi.h"
#include "inference.h"

namespace nb = nanobind;
using namespace nb::literals;
namespace law = fuzzy_pdi;

namespace {

template <typename T>
using In = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <typename T>
using Out = nb::ndarray<nb::numpy, T, nb::ndim<1>, nb::c_contig>;

// A fresh numpy array and the memory behind it.
template <typename T>
struct Array {
  explicit Array(size_t size) : values(new T[size]), size(size) {}
  Out<T> numpy() {
    T* raw = values.release();
    return Out<T>(raw, {size}, nb::capsule(raw, [](void* p) noexcept { delete[] static_cast<T*>(p); }));
  }
  std::unique_ptr<T[]> values;
  size_t size;
};

template <typename A, typename B>
void same_length(const A& a, const B& b) {
  if (a.shape(0) != b.shape(0)) throw std::invalid_argument("The arrays differ in length.");
}

law::Input split(int32_t value) { return {static_cast<uint16_t>(value < 0 ? -value : value), value < 0}; }

// Every intermediate of one inference, as columns of a row.
struct Intermediates {
  static constexpr size_t columns = 10;
  static constexpr const char* names[columns] = {"e_zero", "e_outer", "ce_zero", "ce_outer", "with",
                                                 "zero",   "against", "size",    "flip",     "no_rule"};
  int32_t row[columns];
};

Intermediates trace(const law::Coefficients& c, int32_t e, int32_t ce) {
  const law::Input error = split(e);
  const law::Input change = split(ce);
  const law::Memberships a = law::fuzzify(c.e[error.negative], error.size);
  const law::Memberships b = law::fuzzify(c.ce[change.negative], change.size);
  const law::Rules rules = law::fire(a, b, error.negative == change.negative);
  const law::Defuzzified u = law::defuzzify(rules);
  const auto i = [](uint32_t value) { return static_cast<int32_t>(value); };
  return {{i(a.zero), i(a.outer), i(b.zero), i(b.outer), i(rules.with), i(rules.zero), i(rules.against), u.size, u.flip,
           u.no_rule}};
}

nb::dict infer_all(const law::Coefficients& c, In<int32_t> e, In<int32_t> ce) {
  same_length(e, ce);
  const size_t n = e.shape(0);
  std::unique_ptr<Array<int32_t>> out[Intermediates::columns];
  for (auto& column : out) column = std::make_unique<Array<int32_t>>(n);
  for (size_t k = 0; k < n; ++k) {
    const Intermediates all = trace(c, e(k), ce(k));
    for (size_t j = 0; j < Intermediates::columns; ++j) out[j]->values[k] = all.row[j];
  }
  nb::dict result;
  for (size_t j = 0; j < Intermediates::columns; ++j) result[Intermediates::names[j]] = out[j]->numpy();
  return result;
}

// u_fuzzy in q15 with its sign, 32768 = 1.0.
int32_t u_of(const law::Coefficients& c, int32_t e, int32_t ce) {
  const law::Input error = split(e);
  const law::Defuzzified u = law::infer(c, error, split(ce));
  return (error.negative != u.flip) ? -int32_t{u.size} : int32_t{u.size};
}

Out<int32_t> surface(const law::Coefficients& c, In<int32_t> e, In<int32_t> ce) {
  same_length(e, ce);
  Array<int32_t> u(e.shape(0));
  for (size_t k = 0; k < u.size; ++k) u.values[k] = u_of(c, e(k), ce(k));
  return u.numpy();
}

law::Coefficients compiled(const law::Settings& settings, uint8_t period_ms) {
  law::Coefficients out;
  const law::Refusal refusal = law::compile(settings, period_ms, out);
  if (refusal != law::Refusal::none)
    throw std::invalid_argument("The settings are refused for reason " + std::to_string(static_cast<int>(refusal)) +
                                ".");
  return out;
}

struct Controller {
  law::Coefficients coefficients;
  law::State state;
};

nb::dict run(Controller& self, In<int16_t> leader, In<int16_t> follower, In<uint16_t> limit_mv) {
  same_length(leader, follower);
  same_length(leader, limit_mv);
  const size_t n = leader.shape(0);
  Array<int16_t> u(n), volts(n);
  Array<int32_t> integral(n);
  Array<uint16_t> fraction(n);
  Array<bool> saturated(n), no_rule(n);
  for (size_t k = 0; k < n; ++k) {
    const law::Output out = law::step(self.coefficients, self.state, leader(k), follower(k), limit_mv(k));
    u.values[k] = out.u_fuzzy;
    volts.values[k] = out.volts_mv;
    saturated.values[k] = out.saturated;
    no_rule.values[k] = out.no_rule;
    integral.values[k] = self.state.integral;
    fraction.values[k] = self.state.fraction;
  }
  nb::dict result;
  result["u_fuzzy"] = u.numpy();
  result["volts_mv"] = volts.numpy();
  result["saturated"] = saturated.numpy();
  result["no_rule"] = no_rule.numpy();
  result["integral"] = integral.numpy();
  result["fraction"] = fraction.numpy();
  return result;
}

// The law by its nine rules in double precision, for exhaustive comparison: its own rounding is below 1e-9 LSB of q15.
struct Triple {
  double n, z, p;
};

// x and the corners in the same unit, in which `one` is 1.
Triple memberships(double x, double n_c, double z_a, double z_c, double p_b, double one) {
  x = std::clamp(x, -one, one);
  return {std::clamp(x / n_c, 0.0, 1.0), x < 0 ? std::max(0.0, 1.0 - x / z_a) : std::max(0.0, 1.0 - x / z_c),
          std::clamp(x / p_b, 0.0, 1.0)};
}

double by_rules(const Triple& e, const Triple& ce) {
  const double up = std::max({std::min(e.z, ce.p), std::min(e.p, ce.z), std::min(e.p, ce.p)});
  const double none = std::max({std::min(e.n, ce.p), std::min(e.z, ce.z), std::min(e.p, ce.n)});
  const double down = std::max({std::min(e.n, ce.n), std::min(e.n, ce.z), std::min(e.z, ce.n)});
  return (up - down) / (up + none + down);
}

// The largest distance between the integer law and the one above, in LSB of q15, over all e and ce of a rectangle.
double worst_difference(const law::Settings& s, uint8_t period_ms, std::array<int32_t, 2> e_range,
                        std::array<int32_t, 2> ce_range) {
  const law::Coefficients c = compiled(s, period_ms);
  struct Both {
    bool negative;
    law::Memberships ours;
    Triple exact;
  };
  std::vector<Both> changes;
  for (int32_t ce = ce_range[0]; ce <= ce_range[1]; ++ce) {
    const law::Input input = split(ce);
    const double y = s.kd / 65536.0 * 20 / (s.ce_ticks * period_ms) * ce / 4096;
    changes.push_back({input.negative, law::fuzzify(c.ce[input.negative], input.size),
                       memberships(y * 16384, s.nce_c, s.zce_a, s.zce_c, s.pce_b, 16384)});
  }
  double worst = 0;
  for (int32_t e = e_range[0]; e <= e_range[1]; ++e) {
    const law::Input input = split(e);
    const law::Memberships ours = law::fuzzify(c.e[input.negative], input.size);
    const Triple exact = memberships(s.kp / 65536.0 * e / 4096 * 16384, s.ne_c, s.ze_a, s.ze_c, s.pe_b, 16384);
    for (const Both& change : changes) {
      const law::Defuzzified u = law::defuzzify(law::fire(ours, change.ours, input.negative == change.negative));
      const double q15 = input.negative != u.flip ? -static_cast<double>(u.size) : static_cast<double>(u.size);
      worst = std::max(worst, std::abs(q15 - 32768 * by_rules(exact, change.exact)));
    }
  }
  return worst;
}

}  // namespace

void bind_fuzzy(nb::module_& m) {
  nb::class_<law::Settings>(m, "FuzzySettings", "One joint's controller as stored: sets q14, gains q16, Ku in mV.")
      .def(nb::init<>())
      .def_rw("ne_c", &law::Settings::ne_c)
      .def_rw("ze_a", &law::Settings::ze_a)
      .def_rw("ze_c", &law::Settings::ze_c)
      .def_rw("pe_b", &law::Settings::pe_b)
      .def_rw("nce_c", &law::Settings::nce_c)
      .def_rw("zce_a", &law::Settings::zce_a)
      .def_rw("zce_c", &law::Settings::zce_c)
      .def_rw("pce_b", &law::Settings::pce_b)
      .def_rw("kp", &law::Settings::kp)
      .def_rw("kd", &law::Settings::kd)
      .def_rw("ki", &law::Settings::ki)
      .def_rw("ku_mv", &law::Settings::ku_mv)
      .def_rw("ce_ticks", &law::Settings::ce_ticks);

  m.def(
      "fuzzy_refusal",
      [](const law::Settings& settings, uint8_t period_ms) {
        law::Coefficients unused;
        return static_cast<int>(law::compile(settings, period_ms, unused));
      },
      "settings"_a, "period_ms"_a, "The reason why compile() refuses these settings; 0 when it takes them.");

  m.def("fuzzy_worst_difference", &worst_difference, "settings"_a, "period_ms"_a, "e"_a, "ce"_a,
        nb::call_guard<nb::gil_scoped_release>(),
        "Largest distance of u_fuzzy from the law in double precision, in LSB of q15, over [first, last] of e and ce.");

  nb::class_<Controller>(m, "FuzzyController", "The compiled law of one joint with its memory.")
      .def(
          "__init__",
          [](Controller* self, const law::Settings& settings, uint8_t period_ms) {
            new (self) Controller{compiled(settings, period_ms), {}};
            law::reset(self->coefficients, self->state);
          },
          "settings"_a, "period_ms"_a)
      .def("reset", [](Controller& self) { law::reset(self.coefficients, self.state); })
      .def("run", &run, "leader"_a, "follower"_a, "limit_mv"_a, "step() over arrays of angles (q12) and limits.")
      .def(
          "infer",
          [](const Controller& self, In<int32_t> e, In<int32_t> ce) { return infer_all(self.coefficients, e, ce); },
          "e"_a, "ce"_a, "Every intermediate of the inference for e and ce in 1/4096 rad.")
      .def(
          "u", [](const Controller& self, In<int32_t> e, In<int32_t> ce) { return surface(self.coefficients, e, ce); },
          "e"_a, "ce"_a, "u_fuzzy in q15, 32768 = 1.0.")
      .def_prop_ro("coefficients", [](const Controller& self) {
        const law::Coefficients& c = self.coefficients;
        nb::list sides;
        for (const law::Side* side : {&c.e[0], &c.e[1], &c.ce[0], &c.ce[1]})
          sides.append(nb::make_tuple(side->zero, side->outer, side->short_ramps));
        nb::dict result;
        result["sides"] = sides;
        result["integral"] = c.integral;
        result["ku_mv"] = c.ku_mv;
        result["ce_ticks"] = c.ce_ticks;
        return result;
      });
}
