"""End stops: never passed, never sticky, and they only take energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.arm import Arm


@pytest.fixture(params=["geared", "rigid"])
def short_arm(request: pytest.FixtureRequest, make_arm: Any, rigid: Any) -> Arm:
    stops = {"stops": {"min": -0.4, "max": 0.3}}
    return Arm(make_arm(every_joint=stops | (rigid if request.param == "rigid" else {})))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_pressed_link_rests_on_its_stop_and_leaves_at_once(short_arm: Arm, side: float) -> None:
    for _ in range(100):
        short_arm.step(np.full(4, side * 10.0), 0.01)
    np.testing.assert_array_equal(short_arm.angles, 0.3 if side > 0 else -0.4)
    np.testing.assert_array_equal(short_arm.velocities, 0.0)
    before = short_arm.angles
    for _ in range(10):
        short_arm.step(np.full(4, -side * 10.0), 0.01)
    assert (side * (before - short_arm.angles) > 0.05).all()


def test_impact_takes_energy_and_the_neighbour_feels_it(make_arm: Any, no_friction: Any, rigid: Any) -> None:
    """The shoulder hits its stop: the wrist, coupled with it, is thrown on, and kinetic energy falls."""
    parameters = make_arm(gravity=0.0, every_joint=no_friction | rigid, joint_1={"stops": {"min": -0.4, "max": 0.3}})
    arm = Arm(parameters)
    while arm.angles[1] < 0.3:
        energy, wrist = arm.kinetic_energy, arm.velocities[2]
        arm.step([0.0, 6.0, 0.0, 0.0], 0.25e-3)
    assert arm.velocities[1] == 0.0
    assert arm.velocities[2] > wrist + 0.1
    assert arm.kinetic_energy < energy
