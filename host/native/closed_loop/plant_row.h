// An arm as one row of numbers.
#pragma once

#include <cstddef>

#include "arm/arm.h"
#include "closed_loop/experiment.h"

namespace greywhale::loop {

inline PlantRow plant_row(const arm::ArmParameters& parameters) {
  PlantRow row{};
  row.plant.body = arm::rigid_body(parameters);
  for (std::size_t i = 0; i < kJoints; ++i) row.plant.joints[i] = parameters.joints[i];
  row.supply = parameters.drive.supply;
  return row;
}

}  // namespace greywhale::loop
