"""A plant's columns by name: each holds what its name says of the arm."""

from __future__ import annotations

import pytest

from greywhale import _native
from greywhale.arm import ArmParameters
from greywhale.arm.plants import PLANT_COLUMNS, plant_row
from greywhale.files.arm import load_arm


def named(arm: ArmParameters) -> dict[str, float]:
    return dict(zip(_native.PLANT_COLUMN_NAMES, map(float, plant_row(arm)), strict=True))


def test_names_are_those_of_the_python_tables() -> None:
    assert isinstance(_native.PLANT_COLUMN_NAMES, tuple)
    assert tuple(PLANT_COLUMNS) == _native.PLANT_COLUMN_NAMES
    assert len(set(_native.PLANT_COLUMN_NAMES)) == _native.PLANT_COLUMNS


@pytest.mark.parametrize("name", ["default", "white_box", "grey_box", "worn"])
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
        }
        found = {column.split(".")[1]: columns[column] for column in columns if column.startswith(f"joint{index}.")}
        assert found == expected
