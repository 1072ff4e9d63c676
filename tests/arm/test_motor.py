"""Motors: the two readings of the motor equation, the voltage limits, and motion against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from greywhale.arm import Arm
from greywhale.files.arm import load_arm


def test_physical_equation(make_arm: Any) -> None:
    motor = {"inertia": 2e-5, "resistance": 4.0, "torque_constant": 0.02, "viscous": 1e-5, "gear_ratio": 50.0}
    actuator = make_arm(joint_0={"motor": motor}).actuator(0)
    assert actuator.torque_per_volt == pytest.approx(50 * 0.02 / 4)
    assert actuator.inertia == pytest.approx(50**2 * 2e-5)
    assert actuator.damping == pytest.approx((50 * 0.02) ** 2 / 4 + 50**2 * 1e-5)


def test_papers_reading_gives_the_audited_speeds_and_times() -> None:
    """Grey-box column: volts per speed d, and the time constant of motor plus link where the link does not matter."""
    grey = load_arm("grey_box")
    volts_per_speed = [grey.actuator(i).damping / grey.actuator(i).torque_per_volt for i in range(4)]
    assert volts_per_speed == pytest.approx([9.52, 3.75, 8.63, 8.34], abs=0.005)
    constants = [grey.actuator(i).inertia / grey.actuator(i).damping for i in range(4)]
    assert constants == pytest.approx([0.0120, 0.286, 0.00296, 0.059], rel=0.02)


def test_roll_joint_follows_its_exponential(make_arm: Any, no_friction: Any, rigid: Any) -> None:
    """At zero pitch the roll joint is a single inertia with damping: its response to a step of voltage is known."""
    parameters = make_arm("default", gravity=0.0, every_joint=no_friction | rigid)
    actuator = parameters.actuator(3)
    inertia = actuator.inertia + parameters.link[3].inertia.xx
    speed, time_constant = 3.0 * actuator.torque_per_volt / actuator.damping, inertia / actuator.damping
    arm = Arm(parameters)
    for step in range(1, 301):
        t = step * 1e-3
        angle = arm.step([0.0, 0.0, 0.0, 3.0], 1e-3)[3]
        exact = speed * (t - time_constant * (1 - math.exp(-t / time_constant)))
        assert angle == pytest.approx(exact, abs=1.5e-4 * speed)
    np.testing.assert_array_equal(arm.angles[:3], 0.0)


def test_supply_limits_the_voltage(make_arm: Any) -> None:
    parameters = make_arm(gravity=0.0)
    full, beyond = Arm(parameters, seed=3), Arm(parameters, seed=3)
    np.testing.assert_array_equal(
        full.step([15.0, -15.0, 15.0, -15.0], 0.2), beyond.step([99.0, -1e9, 16.0, -15.1], 0.2)
    )


def test_pwm_levels_round_the_voltage(make_arm: Any) -> None:
    parameters = make_arm(drive={"pwm_levels": 10})  # steps of 1.5 V
    fine = make_arm()
    coarse = Arm(parameters, seed=1).step([2.1, -2.1, 3.7, 0.7], 0.2)
    rounded = Arm(fine, seed=1).step([1.5, -1.5, 3.0, 0.0], 0.2)
    np.testing.assert_array_equal(coarse, rounded)
    assert not np.array_equal(rounded, Arm(fine, seed=1).step([2.1, -2.1, 3.7, 0.7], 0.2))
