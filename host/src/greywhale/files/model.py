"""model.toml: the identified arm as a whole arm file, with a table that tells how it came about and how sure it is."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greywhale.arm import ArmParameters
from greywhale.identify.noise import TRACK
from greywhale.identify.space import JOINTS, column

Floats = NDArray[np.float64]
# Of a motor's damping at most this share may be back-EMF, so that viscous friction stays positive.
BACK_EMF_SHARE = 0.95
MOST_NOISE_V = 0.5  # an arm file holds no more


def arm_of(
    arm: ArmParameters, plant: Floats, zero: Floats, name: str, source: str, noise: Floats | None = None
) -> ArmParameters:
    """An identified plant as an arm: the user's file with other motors, friction, gears and zero angles.

    `noise` (4,) is that of the follower's potentiometers, V rms, if they turn 300 degrees. The leader's are taken to be
    of the same make, and no better: the log of a led arm tells nothing of them.
    """
    data = arm.model_dump(exclude={"identification"})
    data |= {"name": name, "source": source}
    for joint in range(JOINTS):
        one = data["joint"][joint]
        one["motor"] = _motor(arm, joint, plant)
        one["friction"] = {
            "coulomb": _cell(plant, joint, "coulomb"),
            "breakaway": max(_cell(plant, joint, "breakaway"), _cell(plant, joint, "coulomb")),
            "stribeck_velocity": _cell(plant, joint, "stribeck_velocity"),
        }
        one["gear"] = {
            "half_gap": _cell(plant, joint, "half_gap"),
            "stiffness": _cell(plant, joint, "stiffness"),
            "damping": _cell(plant, joint, "mesh_damping"),
            "drag": _cell(plant, joint, "drag"),
        }
        pot = data["follower_pots"]["joint"][joint]
        pot["centre"] = float(pot["centre"] + zero[joint])
        if noise is not None:
            pot["noise"] = min(float(noise[joint]) * TRACK / pot["track"], MOST_NOISE_V)
            of_leader = data["leader_pots"]["joint"][joint]
            of_leader["noise"] = max(of_leader["noise"], pot["noise"])
    return ArmParameters.model_validate(data, strict=False)


def _cell(plant: Floats, joint: int, name: str) -> float:
    return float(plant[column(joint, name)])


def _motor(arm: ArmParameters, joint: int, plant: Floats) -> dict[str, float]:
    """Five motor values with the three identified combinations; gear ratio and, if possible, Kt are the user's."""
    known = arm.joint[joint].motor
    torque, inertia, damping = (_cell(plant, joint, name) for name in ("torque_per_volt", "inertia", "damping"))
    ratio = known.gear_ratio
    physical = arm.motor_equation == "physical"
    # Back-EMF's part of the damping is N Kt x torque per volt in both equations.
    constant = min(known.torque_constant, BACK_EMF_SHARE * damping / (torque * ratio))
    left = damping - torque * constant * ratio
    squared = ratio * ratio
    return {
        "inertia": inertia / squared if physical else inertia / ratio,
        "resistance": (ratio * constant if physical else constant) / torque,
        "torque_constant": constant,
        "viscous": left / squared if physical else left,
        "gear_ratio": ratio,
    }


def to_toml(arm: ArmParameters, identification: Mapping[str, Any]) -> str:
    """The text of a model.toml."""
    data = arm.model_dump(exclude={"identification"})
    tables = {key: value for key, value in data.items() if isinstance(value, dict | list | tuple)}
    lines = ["# Written by greywhale identify. An arm file like any other, with one table more: [identification].", ""]
    lines += [f"{key} = {_value(value)}" for key, value in data.items() if key not in tables]
    for key, value in tables.items():
        for one in value if isinstance(value, list | tuple) else [value]:
            header = f"[[{key}]]" if isinstance(value, list | tuple) else f"[{key}]"
            lines += ["", header, *(f"{name} = {_value(item)}" for name, item in one.items())]
    lines += ["", "[identification]"]
    lines += [f"{key} = {_value(value)}" for key, value in identification.items() if not _is_table_array(value)]
    for key, value in identification.items():
        if _is_table_array(value):
            for one in value:
                lines += ["", f"[[identification.{key}]]"]
                lines += [f"{name} = {_value(item)}" for name, item in one.items()]
    return "\n".join(lines) + "\n"


def _is_table_array(value: object) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)


def _value(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, Mapping):
        pairs = (f"{key if key.isidentifier() else json.dumps(key)} = {_value(item)}" for key, item in value.items())
        return "{ " + ", ".join(pairs) + " }" if value else "{}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    raise TypeError(f"{value!r} has no form in TOML")
