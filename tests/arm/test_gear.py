"""Backlash: the link lags the motor by the gap, in a loop of the right width."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.arm import Arm
from greywhale.files.arm import default_arm


def test_link_moves_freely_by_the_gap_and_then_against_the_teeth(make_arm: Any) -> None:
    """Motors stuck, the link pushed to and fro by hand: it travels the whole gap plus the bending of the teeth."""
    parameters = make_arm(every_joint={"friction": {"coulomb": 2.0, "breakaway": 2.0}})
    torque = 0.03
    arm = Arm(parameters)
    arm.reset([0.0, np.pi / 2, 0.0, 0.0])
    reached = []
    for direction in (1.0, -1.0):
        arm.set_load([direction * torque, 0.0, 0.0, direction * torque])
        arm.step(np.zeros(4), 3.0)
        reached.append(arm.angles)
    travel = reached[0] - reached[1]
    for joint in (0, 3):
        gear = parameters.joint[joint].gear
        assert travel[joint] == pytest.approx(2 * gear.half_gap + 2 * torque / gear.stiffness, rel=1e-3)


def test_teeth_hold_under_violent_driving() -> None:
    """Motor and link never part by more than the gap and the bending that the torques at hand can cause."""
    parameters = default_arm()
    arm = Arm(parameters)
    rng = np.random.default_rng(2)
    gaps = np.array([joint.gear.half_gap for joint in parameters.joint])
    strongest = np.array([parameters.actuator(i).torque_per_volt * 15.0 for i in range(4)])
    bend = 3 * strongest / np.array([joint.gear.stiffness for joint in parameters.joint])
    for _ in range(3000):
        arm.step(rng.choice([-15.0, 0.0, 15.0], 4), 2e-3)
        assert (np.abs(arm.motor_angles - arm.angles) < gaps + bend).all()
    assert arm.unsettled_steps == 0


def test_rigid_gear_is_one_body(make_arm: Any, rigid: Any) -> None:
    arm = Arm(make_arm(every_joint=rigid))
    rng = np.random.default_rng(2)
    for _ in range(2000):
        arm.step(rng.choice([-15.0, 0.0, 15.0], 4), 1e-3)
        np.testing.assert_allclose(arm.motor_angles, arm.angles, rtol=0, atol=1e-12)


def test_stiff_teeth_without_gap_approach_the_rigid_gear(make_arm: Any, rigid: Any) -> None:
    stiff = {"gear": {"half_gap": 0.0, "stiffness": 1e6, "damping": 10.0, "drag": 0.0}}
    one, other = Arm(make_arm(every_joint=rigid)), Arm(make_arm(every_joint=stiff))
    for step in range(300):
        volts = 5 * np.sin(0.02 * step * np.array([1.0, 1.3, 1.7, 2.1]))
        np.testing.assert_allclose(one.step(volts, 1e-3), other.step(volts, 1e-3), rtol=0, atol=1e-4)


def test_seed_places_the_gears_in_their_gaps() -> None:
    parameters = default_arm()
    gaps = np.array([joint.gear.half_gap for joint in parameters.joint])
    places = np.array([Arm(parameters, seed).motor_angles / gaps for seed in range(200)])
    assert (np.abs(places) <= 1).all()
    assert np.abs(places.mean(axis=0)).max() < 0.15
    assert places.std(axis=0) == pytest.approx(np.full(4, 1 / np.sqrt(3)), rel=0.15)
