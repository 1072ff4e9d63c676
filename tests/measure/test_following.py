"""The alarm that a joint does not follow at all: false for a healthy arm, true where something is broken."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from greywhale.arm.plants import columns, plant_row
from greywhale.base.types import Floats
from greywhale.files.arm import load_arm
from greywhale.loop import Experiment, human_reaches
from greywhale.measure.following import follows


@pytest.mark.parametrize(
    ("follower", "told"),
    [
        (lambda leader: leader - 0.2, True),
        (lambda leader: 0.5 * leader, True),
        (lambda leader: np.full_like(leader, leader.mean() + 0.1), False),  # its motor has no wires
        (lambda leader: np.full_like(leader, -2.4), False),  # its potentiometer has none
        (lambda leader: -leader, False),  # it runs the wrong way
    ],
)
def test_a_joint_that_does_not_follow_at_all_is_told(follower: Callable[[Floats], Floats], told: bool) -> None:
    time = np.arange(0, 10, 0.01)
    leader = np.sin(2 * time)
    assert follows(leader, follower(leader), 0.01) == told


def test_where_the_leader_rests_moves_little_or_only_just_now_no_joint_is_accused() -> None:
    time = np.arange(0, 10, 0.01)
    assert follows(0.001 * np.sin(time), np.full_like(time, 0.5), 0.01)
    assert follows(0.12 * np.sin(time), np.full_like(time, 0.05), 0.01)
    late = np.where(time < 9.8, 0.0, 0.6)
    assert follows(late, np.zeros_like(time), 0.01)


@pytest.mark.parametrize("kind", ["default", "worn", "sticky"])
def test_no_beginning_of_a_healthy_arms_log_is_an_alarm_but_a_dead_motor_is(kind: str) -> None:
    """With the controllers as shipped, which are soft; a log may end anywhere, also in the first tremor of the hand."""
    arm = load_arm("default" if kind == "default" else "worn")
    healthy = plant_row(arm)
    if kind == "sticky":
        healthy[columns("coulomb")] *= 1.5
        healthy[columns("breakaway")] *= 2.0
        healthy[columns("half_gap")] = 0.04
    dead = healthy.copy()
    dead[columns("torque_per_volt")] *= 1e-6
    for seed in (1, 2):
        experiment = Experiment(human_reaches(seed, 8.0), arm, seed=seed)
        for plant in (healthy, dead):
            angles = experiment.run_exact(None, plant, every=10).angles[0].astype(np.float64)
            leaders = experiment.leader[::10]
            if plant is dead:
                assert not any(follows(*pair, 0.01) for pair in zip(leaders.T, angles.T, strict=True))
                continue
            for rows in range(50, len(angles), 25):
                assert all(follows(*pair, 0.01) for pair in zip(leaders[:rows].T, angles[:rows].T, strict=True))
