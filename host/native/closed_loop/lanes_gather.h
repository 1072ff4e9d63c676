// Plants and controllers of a block, side by side in lanes.
#pragma once

#include <cmath>

#include "arm/sensor.h"
#include "arm/step.h"
#include "arm/supply.h"
#include "block.h"
#include "lanes_controller.h"
#include "lanes_plant.h"
#include "lanes_wear.h"

namespace greywhale::loop::GREYWHALE_INSTRUCTIONS {

template <class Value>
GREYWHALE_INLINE Float gather(const Block& block, const Value& value) {
  float lanes[kBlock];
  for (std::size_t n = 0; n < kBlock; ++n) lanes[n] = static_cast<float>(value(*block.plants[n]));
  return load(lanes);
}

template <class Value>
GREYWHALE_INLINE Int gather_int(const Value& value) {
  std::int32_t lanes[kBlock];
  for (std::size_t n = 0; n < kBlock; ++n) lanes[n] = static_cast<std::int32_t>(value(n));
  return load(lanes);
}

// 2^-30 turns, as far as lanes can count.
inline double units(double radians) {
  constexpr double kMost = INT32_MAX;
  const double exact = radians * (1073741824.0 / 6.283185307179586);
  return exact < -kMost ? -kMost : exact > kMost ? kMost : exact;
}

inline Body body_of(const Block& block) {
  const auto of = [&](double arm::RigidBody<double>::* member) {
    return gather(block, [member](const PlantRow& row) { return row.plant.body.*member; });
  };
  using Rigid = arm::RigidBody<double>;
  Body b;
  b.yaw = of(&Rigid::yaw);
  b.ixx1 = of(&Rigid::ixx1);
  b.iyy1 = of(&Rigid::iyy1);
  b.ixx23 = of(&Rigid::ixx23);
  b.iyy23 = of(&Rigid::iyy23);
  b.izz23 = of(&Rigid::izz23);
  b.ixx3 = of(&Rigid::ixx3);
  b.izz1 = of(&Rigid::izz1);
  b.coupling = of(&Rigid::coupling);
  b.gravity1 = of(&Rigid::gravity1);
  b.gravity2 = of(&Rigid::gravity2);
  return b;
}

inline Joint joint_of(const Block& block, std::size_t i, double h, int top) {
  using Source = arm::Joint<double>;
  const auto of = [&](auto value) {
    return gather(block, [&](const PlantRow& row) { return value(row.plant.joints[i]); });
  };
  const auto rotor_damped = [h](const Source& s) { return s.actuator.inertia + h * s.actuator.damping; };
  const auto mesh = [h](const Source& s) {
    return s.gear.stiffness > 0.0 ? h * (h * s.gear.stiffness + s.gear.damping) : arm::kRigid;
  };
  Joint j;
  j.rotor = of([](const Source& s) { return s.actuator.inertia; });
  j.impulse = gather(
      block, [&](const PlantRow& r) { return h * r.plant.joints[i].actuator.torque_per_volt * r.supply.volts / top; });
  j.coulomb = of([h](const Source& s) { return h * s.friction.coulomb; });
  j.stribeck = of([h](const Source& s) { return h * (s.friction.breakaway - s.friction.coulomb); });
  j.per_stribeck_velocity = of([](const Source& s) { return 1.0 / s.friction.stribeck_velocity; });
  j.breakaway = of([h](const Source& s) { return h * s.friction.breakaway; });
  j.spring = of([h](const Source& s) { return h * s.gear.stiffness; });
  j.gap_push = of([h](const Source& s) { return h * s.gear.stiffness * s.gear.half_gap; });
  j.no_pull = of([h](const Source& s) { return 1e-6 * h * (s.gear.stiffness * s.gear.half_gap + 1e-3); });
  j.gap = of([](const Source& s) { return s.gear.half_gap; });
  j.mesh = of(mesh);
  for (int touching = 0; touching < 2; ++touching) {
    const auto stiff = [=](const Source& s) { return h * s.gear.drag + (touching ? mesh(s) : 0.0); };
    j.stiff[touching] = of(stiff);
    j.give[touching] = of([=](const Source& s) { return 1.0 / (rotor_damped(s) + stiff(s)); });
    j.share[touching] = of([=](const Source& s) { return stiff(s) / (rotor_damped(s) + stiff(s)); });
    j.inertia[touching] =
        of([=](const Source& s) { return rotor_damped(s) * (stiff(s) / (rotor_damped(s) + stiff(s))); });
  }
  const auto stop = [&](double arm::Stops<double>::* side) {
    return gather_int([&](std::size_t n) { return units(block.plants[n]->plant.joints[i].stops.*side); });
  };
  j.stop_min = stop(&arm::Stops<double>::min);
  j.stop_max = stop(&arm::Stops<double>::max);
  j.damped = of(rotor_damped);
  j.load = of([](const Source& s) { return s.friction.load; });
  const auto creeps = [](const Source& s) { return s.friction.creep > 0.0 && s.friction.breakaway > 0.0; };
  j.creep_velocity = of([=](const Source& s) { return creeps(s) ? s.friction.creep : 0.0; });
  j.creep = of([=](const Source& s) { return creeps(s) ? h * s.friction.breakaway / s.friction.creep : 0.0; });
  j.creeps = of([=](const Source& s) { return creeps(s) ? 1.0 : 0.0; });
  return j;
}

// Of the potentiometers' play and lag, in converter counts.
inline Sensors sensors_of(const Block& block, const Pots& pots) {
  Sensors sensors{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto of = [&](auto value) {
      return gather(block, [&](const PlantRow& row) { return value(row.plant.joints[i].sensor); });
    };
    using Source = arm::Sensor<double>;
    const double per_radian = std::fabs(static_cast<double>(pots.gain[i])) * (1073741824.0 / 6.283185307179586);
    sensors.play[i] = of([=](const Source& s) { return per_radian * s.play; });
    sensors.kept[i] = of([](const Source& s) { return arm::lag_of(s.lag, kSlice).kept; });
    sensors.behind[i] = of([](const Source& s) { return arm::lag_of(s.lag, kSlice).behind; });
    for (const PlantRow* row : block.plants) {
      const Source& sensor = row->plant.joints[i].sensor;
      sensors.on = sensors.on || sensor.play > 0.0 || sensor.lag > 0.0;
    }
  }
  return sensors;
}

inline Sag sag_of(const Block& block, const int (&top)[kJoints]) {
  Sag sag{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    sag.fed[i] = gather(block, [&](const PlantRow& row) {
      return row.supply.resistance / row.supply.volts * row.plant.joints[i].actuator.torque_per_volt / top[i];
    });
    sag.load[i] = gather(block, [&](const PlantRow& row) {
      return row.supply.resistance / row.plant.joints[i].actuator.resistance / top[i] / top[i];
    });
  }
  for (const PlantRow* row : block.plants) sag.on = sag.on || row->supply.resistance > 0.0;
  return sag;
}

inline Losses losses_of(const Block& block, const int (&top)[kJoints]) {
  Losses losses{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto steps = [&](double arm::Driver<double>::* side) {
      return gather(block,
                    [&](const PlantRow& row) { return row.plant.joints[i].driver.*side / row.supply.volts * top[i]; });
    };
    losses.up[i] = steps(&arm::Driver<double>::lost_up);
    losses.down[i] = steps(&arm::Driver<double>::lost_down);
  }
  for (const PlantRow* row : block.plants) losses.on = losses.on || arm::has_losses(row->plant.joints);
  return losses;
}

inline bool is_worn(const Block& block) {
  bool worn = false;
  for (const PlantRow* row : block.plants) worn = worn || arm::is_worn(row->plant);
  return worn;
}

inline bool has_rigid_joint(const Block& block) {
  bool found = false;
  for (const PlantRow* row : block.plants) {
    for (const arm::Joint<double>& joint : row->plant.joints) found = found || !arm::has_room(joint.stops);
  }
  return found;
}

inline Side side_of(const Block& block, std::size_t joint, fuzzy_pdi::Side (fuzzy_pdi::Coefficients::*input)[2],
                    std::size_t below) {
  const auto of = [&](auto value) {
    return gather_int([&](std::size_t n) { return value((block.controllers[n][joint].*input)[below]); });
  };
  return {of([](const fuzzy_pdi::Side& s) { return s.zero; }), of([](const fuzzy_pdi::Side& s) { return s.outer; }),
          of([](const fuzzy_pdi::Side& s) { return s.short_ramps & 1   ? 8
                                                   : s.short_ramps & 4 ? 1
                                                                       : 0; }),
          of([](const fuzzy_pdi::Side& s) { return s.short_ramps & 2 ? 8 : 0; })};
}

inline Law law_of(const Block& block, std::size_t joint, bool& short_ramps) {
  using fuzzy_pdi::Coefficients;
  Law law;
  for (std::size_t below = 0; below < 2; ++below) {
    law.e[below] = side_of(block, joint, &Coefficients::e, below);
    law.ce[below] = side_of(block, joint, &Coefficients::ce, below);
    for (std::size_t n = 0; n < kBlock; ++n) {
      const Coefficients& c = block.controllers[n][joint];
      short_ramps = short_ramps || (c.e[below].short_ramps | c.ce[below].short_ramps) != 0;
    }
  }
  law.integral = gather_int([&](std::size_t n) { return block.controllers[n][joint].integral; });
  law.ku = gather_int([&](std::size_t n) { return block.controllers[n][joint].ku_mv; });
  law.ce_ticks = gather_int([&](std::size_t n) { return block.controllers[n][joint].ce_ticks; });
  law.behind = gather_int([&](std::size_t n) { return kBlock * block.controllers[n][joint].ce_ticks - n; });
  return law;
}

}  // namespace greywhale::loop::GREYWHALE_INSTRUCTIONS
