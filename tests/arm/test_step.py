"""The integrator: convergence, determinism, robustness, and what it does with bad input."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from greywhale.arm import Arm, ArmParameters
from greywhale.base.formats import toml_file
from greywhale.files.arm import default_arm, load_arm

Vector = NDArray[np.float64]


def drive(arm: Arm, seconds: float = 2.0, slice_s: float = 5e-3) -> Vector:
    rows = []
    for step in range(round(seconds / slice_s)):
        t = step * slice_s
        volts = np.array([4 * math.sin(3 * t), 3 * math.sin(2 * t + 1), 3 * math.cos(4 * t), 3 * math.sin(5 * t)])
        rows.append(arm.step(volts, slice_s))
    return np.array(rows)


@pytest.mark.parametrize(("name", "bound"), [("white_box", 7e-4), ("grey_box", 1e-4)])
def test_step_converges_in_first_order(name: str, bound: float) -> None:
    exact = drive(Arm(load_arm(name), longest_step_s=5e-6))
    errors = [np.abs(drive(Arm(load_arm(name), longest_step_s=h)) - exact).max() for h in (0.5e-3, 0.25e-3, 0.125e-3)]
    assert errors[1] < bound
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.15)
    assert errors[1] / errors[2] == pytest.approx(2.0, abs=0.15)


def test_default_arm_is_close_to_the_limit_of_small_steps() -> None:
    """With friction and backlash; the light roll link rattles in its gap, so its bound is a part of that gap."""
    exact = drive(Arm(default_arm(), longest_step_s=5e-6))
    error = np.abs(drive(Arm(default_arm())) - exact).max(axis=0)
    assert (error[:3] < 1e-3).all()
    assert error[3] < default_arm().joint[3].gear.half_gap


def test_same_seed_same_bits_and_other_seed_other_motion() -> None:
    one, same, other = (drive(Arm(default_arm(), seed=seed), 0.5) for seed in (5, 5, 6))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)


def test_long_step_is_the_same_as_its_parts() -> None:
    whole, parts = Arm(default_arm()), Arm(default_arm())
    whole.step([5.0, 5.0, -5.0, 5.0], 0.01)
    for _ in range(40):
        parts.step([5.0, 5.0, -5.0, 5.0], 0.25e-3)
    assert whole.steps == parts.steps == 40
    np.testing.assert_allclose(whole.angles, parts.angles, rtol=0, atol=1e-12)


def test_out_array_is_filled_and_returned() -> None:
    fresh, reusing = Arm(default_arm()), Arm(default_arm())
    block = np.zeros(8)
    view = block[4:]
    assert reusing.step([5.0, 5.0, 5.0, 5.0], 0.01, view) is view
    np.testing.assert_array_equal(block[4:], fresh.step([5.0, 5.0, 5.0, 5.0], 0.01))
    np.testing.assert_array_equal(block[:4], 0.0)
    kept = fresh.angles
    fresh.step([5.0, 5.0, 5.0, 5.0], 0.01)
    assert not np.array_equal(kept, fresh.angles), "a returned array must not change later"


@pytest.mark.parametrize(
    ("voltages", "dt", "words"),
    [
        ([0.0, math.nan, 0.0, 0.0], 1e-3, "voltage of joint 1"),
        ([0.0, 0.0, 0.0, math.inf], 1e-3, "voltage of joint 3"),
        ([0.0] * 4, 0.0, "time step"),
        ([0.0] * 4, math.nan, "time step"),
    ],
)
def test_bad_input_is_refused_and_changes_nothing(voltages: list[float], dt: float, words: str) -> None:
    arm = Arm(default_arm())
    arm.step([5.0, 5.0, 5.0, 5.0], 0.05)
    before = (arm.angles, arm.velocities, arm.motor_angles, arm.motor_velocities, arm.steps)
    with pytest.raises(ValueError, match=words):
        arm.step(voltages, dt)
    after = (arm.angles, arm.velocities, arm.motor_angles, arm.motor_velocities, arm.steps)
    for one, other in zip(before, after, strict=True):
        np.testing.assert_array_equal(one, other)


def test_bad_out_array_is_refused_and_changes_nothing() -> None:
    arm = Arm(default_arm())
    locked = np.zeros(4)
    locked.flags.writeable = False
    bad: Any
    for bad in (np.zeros(4, dtype=np.float32), np.zeros(5), np.zeros(8)[::2], locked, [0.0] * 4):
        with pytest.raises(TypeError, match="out must be"):
            arm.step([9.0] * 4, 0.01, bad)
    assert arm.steps == 0


def test_reset_refuses_angles_beyond_the_stops() -> None:
    arm = Arm(default_arm())
    with pytest.raises(ValueError, match="joint 2 is 2.6.*between the stops"):
        arm.reset([0.0, 0.0, 2.6, 0.0])
    with pytest.raises(ValueError, match="joint 0 is nan"):
        arm.reset([math.nan, 0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match="load of joint 1"):
        arm.set_load([0.0, math.inf, 0.0, 0.0])


def spread(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(math.log(low), math.log(high)).map(math.exp)


@st.composite
def arms(draw: st.DrawFn) -> ArmParameters:
    """Arms far from the shipped ones: heavy and tiny motors, sticky and free, loose and rigid gears, narrow stops."""
    data = default_arm().model_dump(mode="json")
    for joint in data["joint"]:
        joint["motor"] = {key: value * draw(spread(0.02, 50)) for key, value in joint["motor"].items()}
        coulomb = draw(spread(1e-3, 3))
        joint["friction"] = {
            "coulomb": coulomb,
            "breakaway": coulomb * draw(st.floats(1, 3)),
            "stribeck_velocity": draw(spread(3e-3, 1)),
        }
        rigid = draw(st.booleans())
        gap = 0.0 if rigid else draw(st.floats(0, 0.02))
        joint["gear"] = {
            "half_gap": gap,
            "stiffness": 0.0 if rigid else draw(spread(5, 5000)),
            "damping": 0.0 if rigid else draw(spread(1e-3, 5)),
            "drag": draw(spread(1e-4, 1)),
        }
        joint["stops"] = {"min": draw(st.floats(-2.5, -0.05)), "max": draw(st.floats(0.05, 2.5))}
    return toml_file.check(data, ArmParameters, "drawn")


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    parameters=arms(),
    seed=st.integers(0, 2**32),
    volts=st.lists(st.sampled_from([-15.0, -3.0, 0.0, 3.0, 15.0]), min_size=4, max_size=40),
)
def test_any_arm_stays_finite_settled_and_within_its_stops(
    parameters: ArmParameters, seed: int, volts: list[float]
) -> None:
    arm = Arm(parameters, seed)
    low = np.array([joint.stops.min for joint in parameters.joint])
    high = np.array([joint.stops.max for joint in parameters.joint])
    for index in range(len(volts)):
        angles = arm.step(np.roll(np.resize(volts, len(volts) + 4), index)[:4], 0.01)
        assert np.isfinite(arm.velocities).all()
        assert (angles >= low).all()
        assert (angles <= high).all()
    assert arm.unsettled_steps == 0
