"""The voltage that starts a joint, against the simulated arm itself."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.arm import Arm, ArmParameters
from greywhale.arm.holding import starting_volts
from greywhale.arm.plants import plant_row
from greywhale.files.arm import load_arm

WIDE = np.full(4, 2.0)


def way(arm: ArmParameters, joint: int, volts: float) -> float:
    """How far a joint goes upwards within a second from the level pose, under a voltage; the others hold theirs."""
    plant = Arm(arm, seed=1)
    plant.reset(np.zeros(4))
    needs = starting_volts(plant_row(arm), -WIDE, WIDE)
    held = 0.75 * needs * (np.arange(4) > 0)
    held[joint] = volts
    for _ in range(1000):
        angles = plant.step(held, 1e-3)
    return float(angles[joint])


@pytest.mark.parametrize("joint", [0, 1, 2, 3])
def test_a_little_less_leaves_a_joint_where_it_is_and_a_little_more_starts_it(joint: int) -> None:
    arm = load_arm("default")
    need = starting_volts(plant_row(arm), -WIDE, WIDE)[joint]
    assert way(arm, joint, 0.9 * need) < 0.03, "rad: the play of the gears"
    assert way(arm, joint, 1.15 * need) > 0.1


def test_a_range_away_from_level_needs_less() -> None:
    plant = plant_row(load_arm("default"))
    level = starting_volts(plant, -WIDE, WIDE)
    raised = starting_volts(plant, np.array([-2.0, 1.0, -0.1, -2.0]), np.array([2.0, 1.4, 0.1, 2.0]))
    assert np.all(raised[[1, 2]] < 0.9 * level[[1, 2]])
    np.testing.assert_array_equal(raised[[0, 3]], level[[0, 3]])


def test_a_supply_that_sags_asks_for_more() -> None:
    arm = load_arm("default")
    weak = arm.model_copy(update={"drive": arm.drive.model_copy(update={"supply_resistance": 1.0})})
    assert np.all(starting_volts(plant_row(weak), -WIDE, WIDE) > 1.02 * starting_volts(plant_row(arm), -WIDE, WIDE))
