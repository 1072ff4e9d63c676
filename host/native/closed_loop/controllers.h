// Controllers as the firmware stores them, compiled by the firmware's own code.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "experiment.h"

namespace greywhale::loop {

// One joint's controller: eight set corners, three gains, Ku, ce_ticks; greywhale.protocol.table names these columns in
// the same order.
constexpr std::size_t kControllerColumns = 13;

fuzzy_pdi::Refusal compile(const std::int32_t* columns, int period_ms, fuzzy_pdi::Coefficients& result);

// `count` x 4 x 13 numbers. Throws std::invalid_argument that names the first controller which the firmware refuses.
std::vector<Controllers> compiled(const std::int32_t* table, std::size_t count, int period_ms);

}  // namespace greywhale::loop
