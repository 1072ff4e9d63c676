"""A plant's columns hold what their names say, and an identified plant becomes an arm file again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.arm.from_plant import arm_of, known_before
from greywhale.arm.plants import plant_row
from greywhale.files.arm import load_arm
from greywhale.protocol.firmware import JOINTS
from tests.support.arms import make_arm


def named(arm: ArmParameters) -> dict[str, float]:
    return dict(zip(_native.PLANT_COLUMN_NAMES, map(float, plant_row(arm)), strict=True))


@pytest.mark.parametrize("name", ["white_box", "worn"])
def test_columns_hold_what_they_are_called(name: str) -> None:
    arm = load_arm(name)
    columns = named(arm)
    assert columns["supply"] == arm.drive.supply
    assert columns["supply_resistance"] == arm.drive.supply_resistance
    for index, joint in enumerate(arm.joint):
        actuator = arm.actuator(index)
        expected = {
            "torque_per_volt": actuator.torque_per_volt,
            "inertia": actuator.inertia,
            "damping": actuator.damping,
            "resistance": actuator.resistance,
            "coulomb": joint.friction.coulomb,
            "breakaway": joint.friction.breakaway,
            "stribeck_velocity": joint.friction.stribeck_velocity,
            "load_friction": joint.friction.load,
            "creep_velocity": joint.friction.creep_velocity,
            "half_gap": joint.gear.half_gap,
            "stiffness": joint.gear.stiffness,
            "mesh_damping": joint.gear.damping,
            "drag": joint.gear.drag,
            "stop_min": joint.stops.min,
            "stop_max": joint.stops.max,
            "pot_play": arm.follower_pots.joint[index].play,
            "pot_lag": arm.follower_pots.joint[index].lag,
            "lost_up": joint.driver.lost_up,
            "lost_down": joint.driver.lost_down,
        }
        found = {column.split(".")[1]: columns[column] for column in columns if column.startswith(f"joint{index}.")}
        assert found == expected


def identified(arm: ArmParameters) -> ArmParameters:
    """The arm after an identification that found other values for all that it looks for."""
    plant = plant_row(arm) * 1.25 + 1e-4
    return arm_of(arm, plant, np.full(JOINTS, 0.02), "found", "a test", np.full(JOINTS, 3e-3))


WEAK_SUPPLY = {"resistance": 0.3, "supply_resistance": 0.2}


@pytest.mark.parametrize("name", ["default", "white_box", "two_joints"])
def test_what_is_known_before_is_what_an_identification_leaves(name: str) -> None:
    arm = make_arm(name, drive=WEAK_SUPPLY)
    assert known_before(identified(arm)) == known_before(arm)


def leaves(data: Any, path: str = "") -> dict[str, Any]:
    if isinstance(data, dict):
        return {key: value for name, part in data.items() for key, value in leaves(part, f"{path}.{name}").items()}
    if isinstance(data, list | tuple):
        return {key: value for index, part in enumerate(data) for key, value in leaves(part, f"{path}.{index}").items()}
    return {path: data}


def test_all_that_an_identification_may_change_is_left_out() -> None:
    arm = make_arm(drive=WEAK_SUPPLY)
    before, after = leaves(arm.model_dump()), leaves(identified(arm).model_dump())
    changed = {path for path in before if before[path] != after.get(path)}
    assert {".drive.resistance", ".drive.supply_resistance", ".follower_pots.joint.0.lag"} <= changed
    assert not changed & {path for path in leaves(known_before(arm)) if not path.endswith(".name")}
