// An arm that a page was given, as the row of numbers by which it is simulated.
#include <algorithm>

#include "arm/motor.h"
#include "closed_loop/plant_row.h"
#include "experiments.h"

namespace greywhale::web {
namespace {

arm::Joint<double> joint_of(Reader& reader, bool paper) {
  const arm::Motor motor{reader.next(), reader.next(), reader.next(), reader.next(), reader.next()};
  arm::Joint<double> joint{};
  joint.actuator = paper ? arm::paper_actuator(motor) : arm::physical_actuator(motor);
  joint.friction = {reader.next(), reader.next(), reader.next(), reader.next(), reader.next()};
  joint.gear = {reader.next(), reader.next(), reader.next(), reader.next()};
  joint.stops = {reader.next(), reader.next()};
  joint.sensor = {reader.next(), reader.next()};
  joint.driver = {reader.next(), reader.next()};
  return joint;
}

}  // namespace

extern "C" {

// Given: 1 for the paper's equation of a motor, 0 for the physical one; of each link mass, length, centre and three
// inertias; the load, gravity; of each joint five numbers of the motor, five of friction, four of the gear, two stops,
// play and lag of its potentiometer, two losses of its driver; supply and its resistance. Found: the row of the plant.
EXPORT(plant) void exported_plant() {
  Reader reader;
  arm::ArmParameters arm{};
  const bool paper = reader.next() != 0.0;
  for (arm::Link& link : arm.links)
    link = {reader.next(), reader.next(), reader.next(), reader.next(), reader.next(), reader.next()};
  arm.tip_mass = reader.next();
  arm.gravity = reader.next();
  for (arm::Joint<double>& joint : arm.joints) joint = joint_of(reader, paper);
  arm.drive.supply = {reader.next(), reader.next()};
  const loop::PlantRow row = loop::plant_row(arm);
  found.resize(loop::kPlantColumns);
  std::copy_n(reinterpret_cast<const double*>(&row), loop::kPlantColumns, found.begin());
}

}  // extern "C"

}  // namespace greywhale::web
