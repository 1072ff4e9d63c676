"""The saturation floor against closed forms, against what controllers reach, and for what it must not know."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale import _native
from greywhale.arm.plants import column
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm, load_arm
from greywhale.loop import PLANT_COLUMNS, Experiment, human_reaches, leader_slices, multi_steps, plant_row, steps
from greywhale.tune.judge.floor import saturation_floor

TORQUE, INERTIA, SUPPLY = 0.5, 0.05, 10.0
FASTEST = TORQUE * SUPPLY / INERTIA  # rad/s^2


def double_integrators(supply: float = SUPPLY) -> Floats:
    """A plant row of four joints that are nothing but inertia: motors so heavy that their links do not matter."""
    row = plant_row(load_arm("grey_box"))
    for index, place in enumerate(PLANT_COLUMNS):
        name = place.split(".")[-1]
        if name in ("damping", "coulomb", "breakaway", "gravity1", "gravity2", "coupling"):
            row[index] = 0.0
        elif name in ("torque_per_volt", "inertia"):
            row[index] = {"torque_per_volt": TORQUE, "inertia": INERTIA}[name]
        elif "." not in place:
            row[index] = 1e-9
    row[column("supply")] = supply
    return row


def jump(size: float, before_s: float = 0.5, after_s: float = 1.0) -> Floats:
    slices = np.zeros((round((before_s + after_s) * 4000), 4))
    slices[round(before_s * 4000) :] = size
    return slices


def fuller() -> float:
    """The least integral of e^2 from e = 1 at rest with |e''| <= 1 (Fuller 1963): switching at e = -h e' |e'|."""
    h = np.sqrt((np.sqrt(33.0) - 1.0) / 24.0)
    turn = 1.0 / np.sqrt(h + 0.5)
    t = np.linspace(0.0, turn, 200_001)
    towards = np.trapezoid((1.0 - t**2 / 2.0) ** 2, t)
    braking = np.trapezoid((h * turn**2 - turn * t + t**2 / 2.0) ** 2, t)
    overshoot = (0.5 - h) / (0.5 + h)
    return float((towards + braking) / (1.0 - overshoot**2.5))


@pytest.mark.parametrize("size", [1.0, -0.3])
def test_a_jump_of_pure_inertia_costs_what_fuller_found_and_the_bound_what_it_costs_without_brakes(size: float) -> None:
    floor = saturation_floor(jump(size), double_integrators())
    scale = abs(size) ** 2.5 / np.sqrt(FASTEST) / 1.5
    least = fuller() * scale
    assert np.all(floor.mse >= 0.999 * least)
    assert np.all(floor.mse <= 1.01 * least)
    without_brakes = 8.0 / 15.0 * np.sqrt(2.0) * scale
    assert np.all(floor.bound <= without_brakes)
    assert np.all(floor.bound >= 0.98 * without_brakes), "it may leave a tick early"


def test_a_lower_voltage_costs_what_it_must() -> None:
    full, quarter = (saturation_floor(jump(0.5), double_integrators(volts)) for volts in (SUPPLY, SUPPLY / 4))
    np.testing.assert_allclose(quarter.mse / full.mse, 2.0, rtol=0.01)
    np.testing.assert_allclose(quarter.bound / full.bound, 2.0, rtol=0.01)


@pytest.mark.parametrize("name", ["default", "grey_box"])
def test_steps_leave_little_between_floor_and_bound_on_every_arm(name: str) -> None:
    floor = saturation_floor(steps(), load_arm(name))
    assert np.all(floor.bound <= floor.mse)
    assert np.all(floor.mse <= 1.05 * floor.bound)
    assert floor.total <= 1.02 * floor.bound.sum()
    assert floor.limited == (True,) * 5


def test_the_floor_is_of_the_experiments_own_window_and_below_its_controller() -> None:
    motion, arm = multi_steps([0.0, 0.8, -0.4], [0.6, 1.0, 1.0]), default_arm()
    experiment = Experiment(motion, arm, wait_s=0.7)
    floor = saturation_floor(motion, arm, wait_s=0.7)
    np.testing.assert_array_equal(floor.leader, experiment.leader)
    np.testing.assert_allclose(floor.time_s, experiment.time_s, atol=1e-12)
    np.testing.assert_allclose(floor.mse, np.mean((floor.leader - floor.angles) ** 2, axis=0), rtol=1e-12)
    before = experiment.run_exact().mse[0]
    multiples = floor.multiple(before)
    assert all(one is not None and one > 1.1 for one in multiples)
    assert multiples[4] == pytest.approx(before.sum() / floor.total)


def test_the_ideal_controller_does_not_look_ahead() -> None:
    plant = plant_row(default_arm())
    one = leader_slices(steps(0.7, 0.2, 0.4), 0.1)
    other = one.copy()
    other[1600:] = 0.2
    tunings = np.tile([1.0, 0.001, 1.0, 1.0], (1, 4, 1))
    common: dict[str, Any] = {"late": 0, "supply": 15.0, "chased": -1, "keep": True, "threads": 1}
    nowhere: dict[str, Any] = {"direction": np.zeros(len(one), dtype=np.int8), "until": np.zeros(len(one))}
    given = common | nowhere | {"plant": plant, "tunings": tunings}
    angles = [_native.simulate_ideal(leader=leader, **given)[1][0] for leader in (one, other)]
    np.testing.assert_array_equal(angles[0][:401], angles[1][:401])
    assert np.abs(angles[0][420:] - angles[1][420:]).max() > 0.01


def test_what_a_motor_can_keep_up_with_has_no_multiple() -> None:
    floor = saturation_floor(human_reaches(1, 5.0), default_arm())
    assert floor.total < 1e-4
    assert floor.multiple(np.full(4, 0.001)) == (None,) * 5
    slow = saturation_floor(human_reaches(1, 5.0), load_arm("grey_box"))
    assert slow.limited[0], "the grey box's yaw turns 1.6 rad/s at most"


def test_knowing_the_leader_later_costs_more() -> None:
    motion = steps(1.0, 0.5, 0.5)
    now, late = (saturation_floor(motion, default_arm(), wait_s=0.5, delay_s=delay) for delay in (0.0, 0.004))
    assert np.all(late.mse > now.mse)
    assert np.all(late.bound > now.bound)
    # Every millisecond of a jump of 1 rad costs 1 rad^2 x 1 ms.
    np.testing.assert_allclose((late.mse - now.mse) * 1.5, 0.004, rtol=0.25)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"delay_s": -0.1}, "delay_s is -0.1, but it must lie within 0..1 s"),
        ({"arm": np.repeat(double_integrators()[None], 2, axis=0)}, "of one plant, not of 2"),
        ({"motion": jump(1.0) + 2.6}, "the leader starts with joint 0 at 2.6 rad, beyond the follower's stops"),
        ({"motion": jump(1.0)[:-1]}, "the shape (5999, 4), but (4 x ticks, 4) is needed"),
        ({"motion": jump(float("nan"))}, "not a finite number"),
    ],
)
def test_bad_arguments_are_refused_in_a_sentence(change: dict[str, object], complaint: str) -> None:
    arguments: dict[str, Any] = {"motion": jump(1.0), "arm": double_integrators()} | change
    motion, arm = arguments.pop("motion"), arguments.pop("arm")
    with pytest.raises(UserError) as caught:
        saturation_floor(motion, arm, **arguments)
    assert complaint in str(caught.value)
