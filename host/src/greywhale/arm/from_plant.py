"""Turns an identified plant back into an arm file's terms: motors, friction, gears, drivers, and zero angles."""

from __future__ import annotations

from typing import Any

from greywhale.arm.limits import DOUBTS
from greywhale.arm.parameters import USUAL_TRACK_RAD, ArmParameters
from greywhale.arm.plants import column
from greywhale.base.types import Floats
from greywhale.protocol.firmware import JOINTS

# Keys of an arm file's joint -> a plant's columns.
_FRICTION = {name: name for name in ("coulomb", "breakaway", "stribeck_velocity", "creep_velocity")}
_FRICTION["load"] = "load_friction"
_GEAR = {"half_gap": "half_gap", "stiffness": "stiffness", "damping": "mesh_damping", "drag": "drag"}


def arm_of(
    arm: ArmParameters, plant: Floats, zero: Floats, name: str, source: str, noise: Floats | None = None
) -> ArmParameters:
    """An identified plant as an arm: the user's file with other motors, friction, gears, drivers and zero angles.

    `noise` (4,) is that of the follower's potentiometers, V rms, if they turn 300 degrees. The leader's are assumed to
    be of the same make and no better: the log of a led arm shows nothing of them.
    """
    data = arm.model_dump(exclude={"identification"})
    data |= {"name": name, "source": source}
    for joint in range(JOINTS):
        one = data["joint"][joint]
        if arm.joint[joint].fixed:
            continue
        one["motor"] = _motor(arm, joint, plant)
        one["friction"] = {key: _cell(plant, joint, name) for key, name in _FRICTION.items()}
        one["friction"]["breakaway"] = max(one["friction"]["breakaway"], one["friction"]["coulomb"])
        one["gear"] = {key: _cell(plant, joint, name) for key, name in _GEAR.items()}
        one["driver"] = {key: _cell(plant, joint, key) for key in ("lost_up", "lost_down")}
        pot = data["follower_pots"]["joint"][joint]
        pot["play"], pot["lag"] = _cell(plant, joint, "pot_play"), _cell(plant, joint, "pot_lag")
        pot["centre"] = float(pot["centre"] + zero[joint])
        if noise is not None:
            pot["noise"] = min(float(noise[joint]) * USUAL_TRACK_RAD / pot["track"], DOUBTS.most_noise_v)
            of_leader = data["leader_pots"]["joint"][joint]
            of_leader["noise"] = max(of_leader["noise"], pot["noise"])
    data["drive"]["resistance"] = 0.0  # the motors' resistance now has the driver's in it
    data["drive"]["supply_resistance"] = float(plant[column("supply_resistance")])
    return ArmParameters.model_validate(data, strict=False)


def known_before(arm: ArmParameters) -> dict[str, Any]:
    """The values of an arm file that no identification changes: those that `arm_of` does not write."""
    data = arm.model_dump(exclude={"name", "source", "identification"})
    for joint, follower, leader in zip(
        data["joint"], data["follower_pots"]["joint"], data["leader_pots"]["joint"], strict=True
    ):
        for pot, found in ((follower, ("play", "lag", "centre", "noise")), (leader, ("noise",))):
            for name in found:
                del pot[name]
        if not joint.get("fixed"):
            joint["motor"] = {"gear_ratio": joint["motor"]["gear_ratio"]}
            del joint["friction"], joint["gear"], joint["driver"], joint["name"]
    del data["drive"]["resistance"], data["drive"]["supply_resistance"]
    return data


def _cell(plant: Floats, joint: int, name: str) -> float:
    return float(plant[column(name, joint)])


def _motor(arm: ArmParameters, joint: int, plant: Floats) -> dict[str, float]:
    """Five motor values with the three identified combinations; gear ratio and, if possible, Kt are the user's."""
    known = arm.joint[joint].motor
    torque, inertia, damping = (_cell(plant, joint, name) for name in ("torque_per_volt", "inertia", "damping"))
    ratio = known.gear_ratio
    physical = arm.motor_equation == "physical"
    # Back-EMF's part of the damping is N Kt x torque per volt in both equations.
    constant = min(known.torque_constant, DOUBTS.back_emf_share * damping / (torque * ratio))
    left = damping - torque * constant * ratio
    squared = ratio * ratio
    return {
        "inertia": inertia / squared if physical else inertia / ratio,
        "resistance": (ratio * constant if physical else constant) / torque,
        "torque_constant": constant,
        "viscous": left / squared if physical else left,
        "gear_ratio": ratio,
    }
