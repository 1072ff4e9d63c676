// Rows of numbers to controllers: see controllers.h.
#include "closed_loop/controllers.h"

#include <stdexcept>
#include <string>

namespace greywhale::loop {

fuzzy_pdi::Refusal compile(const std::int32_t* c, int period_ms, fuzzy_pdi::Coefficients& result) {
  const auto set = [c](std::size_t i) { return static_cast<std::int16_t>(c[i]); };
  const auto gain = [c](std::size_t i) { return static_cast<std::uint32_t>(c[i]); };
  const auto ku_mv = static_cast<std::uint16_t>(c[11]);
  const auto ce_ticks = static_cast<std::uint8_t>(c[12]);
  const fuzzy_pdi::Settings settings = {set(0), set(1),  set(2),  set(3),   set(4), set(5),  set(6),
                                        set(7), gain(8), gain(9), gain(10), ku_mv,  ce_ticks};
  return fuzzy_pdi::compile(settings, static_cast<std::uint8_t>(period_ms), result);
}

std::vector<Controllers> compiled(const std::int32_t* table, std::size_t count, int period_ms) {
  std::vector<Controllers> all(count);
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const fuzzy_pdi::Refusal refusal = compile(table + (n * kJoints + i) * kControllerColumns, period_ms, all[n][i]);
      if (refusal == fuzzy_pdi::Refusal::none) continue;
      throw std::invalid_argument("controllers[" + std::to_string(n) + ", " + std::to_string(i) +
                                  "] is refused by the firmware with reason " +
                                  std::to_string(static_cast<int>(refusal)) + ".");
    }
  }
  return all;
}

}  // namespace greywhale::loop
