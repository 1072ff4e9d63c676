"""Motors with the values of their data sheets. Links as bodies: tests/oracles/test_link_bodies.py."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from greywhale.arm.make.motor import DataSheet, contradiction, tables
from greywhale.arm.parameters import ArmParameters
from tests.support.arms import make_arm

SHEET = DataSheet(12.0, 100.0, 1.5, 2.0, 6.0, 0.1, 5e-7)


def with_motor(sheet: DataSheet) -> ArmParameters:
    return make_arm(joint_0=tables(sheet))


@given(st.floats(0.05, 20.0), st.floats(0.2, 20.0), st.floats(0.1, 60.0), st.floats(0.01, 0.3), st.floats(1.0, 500.0))
def test_the_data_sheets_line_is_kept(torque: float, current: float, speed: float, idle: float, ratio: float) -> None:
    assume(contradiction(torque, current, speed, 12.0) == "")
    sheet = DataSheet(12.0, ratio, torque, current, speed, idle * current, 5e-7)
    arm = with_motor(sheet)
    actuator, friction = arm.actuator(0), arm.joint[0].friction
    assert actuator.torque_per_volt * 12.0 - friction.coulomb == pytest.approx(torque)
    assert (actuator.torque_per_volt * 12.0 - friction.coulomb) / actuator.damping == pytest.approx(speed)
    assert friction.coulomb == pytest.approx(idle * torque)
    assert actuator.inertia == pytest.approx(5e-7 * ratio**2)
    assert arm.joint[0].motor.viscous >= 0.0


def test_the_winding_is_that_of_the_stall_current() -> None:
    """If back-EMF leaves room for it, the resistance is voltage by stall current."""
    assert with_motor(SHEET).joint[0].motor.resistance == pytest.approx(12.0 / 2.0)


def test_more_power_out_than_in_is_told() -> None:
    told = contradiction(1.5, 2.0, 2 * np.pi, 1.5)
    assert "stall torque x no-load speed is 9.42 W, more than voltage x stall current = 3 W" in told
