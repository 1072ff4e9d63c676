"""Dry friction: rest is rest, coasting slows down linearly, and no energy appears."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.arm import Arm
from greywhale.files.arm import default_arm


def test_rest_is_exact_below_breakaway_and_ends_above() -> None:
    parameters = default_arm()
    breakaway_volts = np.array(
        [parameters.joint[i].friction.breakaway / parameters.actuator(i).torque_per_volt for i in range(4)]
    )
    level = [0.0, np.pi / 2, 0.0, 0.0]  # pointing up: no gravity torque
    for share, moves in ((0.97, False), (-0.97, False), (1.03, True), (-1.03, True)):
        arm = Arm(parameters)
        arm.reset(level)
        start = arm.motor_angles
        for _ in range(100):
            arm.step(share * breakaway_volts, 0.02)
        if moves:
            assert (np.sign(share) * (arm.motor_angles - start) > 0.05).all()
        else:
            np.testing.assert_array_equal(arm.motor_velocities[[0, 3]], 0.0)
            np.testing.assert_array_equal(arm.motor_angles[[0, 3]], start[[0, 3]])


@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0, 0.0), (0.5, 0.7, -0.6, 1.0)])
def test_default_arm_holds_its_pose_unpowered(pose: tuple[float, ...]) -> None:
    """It sinks through its backlash and a little further by the blow, then stands still for good."""
    arm = Arm(default_arm(), seed=1)
    arm.reset(pose)
    off = np.zeros(4)
    settled = arm.step(off, 1.0)
    assert np.abs(settled - pose).max() < 0.03
    motors = arm.motor_angles
    later = arm.step(off, 30.0)
    np.testing.assert_array_equal(arm.motor_velocities, 0.0)
    np.testing.assert_array_equal(arm.motor_angles, motors)
    np.testing.assert_allclose(later, settled, rtol=0, atol=1e-6)


def test_coasting_slows_down_linearly_and_stops(make_arm: Any, rigid: Any) -> None:
    """A motor of huge resistance brakes only by friction: v falls by coulomb / inertia, then is exactly 0."""
    coulomb, inertia = 0.05, 0.02
    joint = rigid | {
        "motor": {"inertia": inertia, "resistance": 1e9, "torque_constant": 1e-3, "viscous": 0.0, "gear_ratio": 1.0},
        "friction": {"coulomb": coulomb, "breakaway": coulomb},
    }
    parameters = make_arm(gravity=0.0, joint_3=joint)
    deceleration = coulomb / (inertia + parameters.link[3].inertia.xx)
    arm = Arm(parameters)
    arm.set_load([0.0, 0.0, 0.0, 0.25])
    arm.step(np.zeros(4), 0.2)
    arm.set_load(np.zeros(4))
    start = arm.velocities[3]
    assert start > 1.5
    for millisecond in range(1, 501):
        arm.step(np.zeros(4), 1e-3)
        expected = max(start - deceleration * 1e-3 * millisecond, 0.0)
        assert arm.velocities[3] == pytest.approx(expected, abs=1e-9)
    arm.step(np.zeros(4), 1.0)
    assert arm.velocities[3] == 0.0


def test_stribeck_friction_is_breakaway_at_rest_and_coulomb_at_speed(make_arm: Any, rigid: Any) -> None:
    """At constant speed the voltage beyond the motor's own need is the friction at that speed."""
    friction = {"coulomb": 0.04, "breakaway": 0.1, "stribeck_velocity": 0.5}
    parameters = make_arm(gravity=0.0, joint_3=rigid | {"friction": friction})
    actuator = parameters.actuator(3)
    for speed, expected in ((0.5, 0.07), (1.5, 0.046)):
        arm = Arm(parameters)
        arm.reset([0.0, 0.0, 0.0, -2.0])
        angle_before = 0.0
        volts = 0.0
        for _ in range(1500):  # a stiff speed controller
            volts = 20.0 * (speed - arm.velocities[3]) + speed * actuator.damping / actuator.torque_per_volt
            angle_before = arm.angles[3]
            arm.step([0.0, 0.0, 0.0, volts], 1e-3)
        steady = (arm.angles[3] - angle_before) / 1e-3
        measured = volts * actuator.torque_per_volt - steady * actuator.damping
        ratio = steady / friction["stribeck_velocity"]
        assert measured == pytest.approx(0.04 + 0.06 / (1 + ratio**2), rel=1e-3)
        assert measured == pytest.approx(expected, rel=0.2)


@pytest.mark.parametrize("seed", range(2))
def test_unpowered_arm_never_gains_energy(seed: int) -> None:
    """Motors shorted: damping, friction, teeth and stops may only take energy."""
    arm = Arm(default_arm(), seed=seed)
    rng = np.random.default_rng(seed)
    for _ in range(10):
        arm.step(rng.uniform(-15, 15, 4), 0.03)
    energy = arm.kinetic_energy + arm.potential_energy
    assert arm.kinetic_energy > 0.01
    for _ in range(4000):
        arm.step(np.zeros(4), 0.25e-3)
        now = arm.kinetic_energy + arm.potential_energy
        assert now <= energy + 1e-7
        energy = now
    assert arm.kinetic_energy < 1e-6
