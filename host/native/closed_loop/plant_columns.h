// The names of a plant's columns, as Python and messages have them.
#pragma once

#include <iterator>
#include <string>
#include <vector>

#include "arm/columns.h"
#include "experiment.h"

namespace greywhale::loop {

static_assert(offsetof(PlantRow, plant.joints) == std::size(arm::kBodyColumns) * sizeof(double),
              "the joints follow the links");
static_assert(offsetof(PlantRow, supply.volts) == (kPlantColumns - 2) * sizeof(double) &&
                  offsetof(PlantRow, supply.resistance) == (kPlantColumns - 1) * sizeof(double),
              "the supply comes last");

inline std::vector<std::string> plant_column_names() {
  std::vector<std::string> names;
  for (const arm::Column& column : arm::kBodyColumns) names.emplace_back(column.name);
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    for (const arm::Column& column : arm::kJointColumns)
      names.push_back("joint" + std::to_string(joint) + "." + column.name);
  }
  names.emplace_back("supply");
  names.emplace_back("supply_resistance");
  return names;
}

}  // namespace greywhale::loop
