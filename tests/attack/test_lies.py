"""Lies that are slow, and two faults at once: each does what its name says, and its cost is counted by itself."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greywhale.arm import Arm
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm
from tools.attack.arm_on_board import SLICE_S
from tools.attack.load import Watch
from tools.attack.part import add_up
from tools.attack.parts.lies import FAR, run
from tools.attack.pot_lies import MIDDLE_MV, MV_PER_RAD
from tools.attack.slow_lies import slow_lies

SHARES = np.linspace(0.3, 1.0, 8)  # of a rate, by which the eight potentiometers turn
FOLLOWER, NEXT, LEADER = 5, 6, 1  # of joint 1


def true(seconds: float, rate: float) -> Floats:
    """The eight angles (rad) after a time; no pot is at the middle of its track."""
    return np.asarray(0.1 + rate * seconds * SHARES)


def readings(name: str, seconds: float, rate: float = 0.3) -> Floats:
    """The readings (rad) of an arm after so many seconds, where a lie at joint 1 began at 0 s."""
    arm: Any = SimpleNamespace(pot_fault=None, motor_signs=np.ones(4), random=np.random.default_rng(1))
    slow_lies()[name](arm, 1)
    for step in range(round(seconds / SLICE_S) + 1):
        volts = MIDDLE_MV + MV_PER_RAD * true(step * SLICE_S, rate)
        if arm.pot_fault is not None:
            arm.pot_fault(volts, step * SLICE_S)
    return np.asarray((volts - MIDDLE_MV) / MV_PER_RAD)


@pytest.mark.parametrize(
    ("name", "pot", "expected"),
    [
        ("follower drifts by 0.05 rad/s", FOLLOWER, true(1.0, 0.3)[FOLLOWER] - 0.05),
        ("follower drifts by 1 rad/s", FOLLOWER, true(1.0, 0.3)[FOLLOWER] - 1.0),
        ("leader drifts by 0.2 rad/s", LEADER, true(1.0, 0.3)[LEADER] - 0.2),
        ("follower's gain falls to 0.5 in 2 s", FOLLOWER, 0.75 * true(1.0, 0.3)[FOLLOWER]),
        ("follower turns by a fifth from here on", FOLLOWER, 0.1 + 0.2 * (true(1.0, 0.3)[FOLLOWER] - 0.1)),
        ("follower late by 150 ms", FOLLOWER, true(0.85, 0.3)[FOLLOWER]),
        ("follower creeps 1 rad at 3 rad/s", FOLLOWER, true(1.0, 0.3)[FOLLOWER] - 1.0),
        ("follower frozen without noise", FOLLOWER, 0.1),
        ("follower frozen, and the next", NEXT, 0.1),
        ("follower frozen, leader drifts by 0.2 rad/s", LEADER, true(1.0, 0.3)[LEADER] - 0.2),
    ],
)
def test_a_reading_is_wrong_by_what_the_name_says(name: str, pot: int, expected: float) -> None:
    found = readings(name, 1.0)
    assert found[pot] == pytest.approx(expected, abs=0.02)
    other = ({FOLLOWER, NEXT, LEADER} if "frozen" in name else {pot}).symmetric_difference(range(8))
    assert found[list(other)] == pytest.approx(true(1.0, 0.3)[list(other)])


def test_the_first_row_says_what_an_arm_does_that_nothing_is_wrong_with() -> None:
    assert readings(next(iter(slow_lies())), 1.0) == pytest.approx(true(1.0, 0.3))


def test_plugs_are_exchanged_from_where_both_read_alike() -> None:
    for name, other in (("follower exchanged with the next", NEXT), ("follower exchanged with its leader", LEADER)):
        angles = true(1.0, 0.3)
        assert readings(name, 1.0)[[FOLLOWER, other]] == pytest.approx(angles[[other, FOLLOWER]])
        apart = readings(name, 0.0)
        assert apart == pytest.approx(true(0.0, 0.3))


@pytest.mark.parametrize("hidden_v", [0.0, 2.0, -4.0])
def test_the_load_that_looks_the_same_is_what_the_readings_do_not_explain(hidden_v: float) -> None:
    arm = Arm(default_arm())
    joint, supply_v = 3, arm.parameters.drive.supply
    at: Any = SimpleNamespace(supply_v=supply_v)
    watch = Watch(at)
    for step in range(8000):
        given = 6.0 * np.sin(2 * np.pi * step * SLICE_S) * (np.arange(4) == joint)
        told = given + hidden_v * (np.arange(4) == joint)
        at.millivolts = np.tile(MIDDLE_MV + MV_PER_RAD * arm.step(given, SLICE_S), 2)
        outputs = np.array([1.0, *np.abs(told) / supply_v, *(told > 0)])
        at.board = SimpleNamespace(outputs=outputs.copy)
        watch.note()
    assert watch.load_v(joint) == pytest.approx(abs(hidden_v), abs=0.6)
    assert watch.load_v(0) == pytest.approx(0.0, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("board", ["mega", "nano"])
def test_what_a_lie_costs_is_counted_with_and_without_the_numbers_of_travel(board: str) -> None:
    names = ["follower drifts by 1 rad/s", "follower drifts by 0.05 rad/s"]
    rows = add_up(row for seed in (0, 1) for row in run({"board": board, "seed": seed, "trials": 1, "faults": names}))
    assert {row.tried.rpartition(", ")[2] for row in rows} == {"travel known", "travel unknown"}
    for row in rows:
        assert row.violations == 0, "nothing is promised"
        assert (row.worst["rad"] > 0.5) == (row.counts.get(FAR, 0) == 1)
    far = {row.tried: row.worst["rad"] for row in rows}
    assert far[f"{board}: follower drifts by 0.05 rad/s, travel known"] < 0.3
    assert far[f"{board}: follower drifts by 1 rad/s, travel known"] > 0.5
