"""A joint that hunts at rest ends the motion at once; nothing else does."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.board.hunting_stop import Hunting, HuntingStop
from greywhale.board.stream import Received
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB

TICKS = np.arange(4000)


def stopped_at(leader: np.ndarray, follower: np.ndarray, every: int = 1) -> float | None:
    """The time (s) at which the watch stops joint 2, None if it never does; the other joints rest."""
    watch = HuntingStop()
    for tick in TICKS[::every]:
        angles = [[0, 0, 0, 0], [0, 0, 0, 0]]
        for row, path in zip(angles, (leader, follower), strict=True):
            row[2] = round(float(path[tick]) / ANGLE_LSB)
        one, other = (tuple(row) for row in angles)
        sample = schema.Sample(int(tick), schema.State.FOLLOWING, schema.Fault.NONE, one, other, (0, 0, 0, 0))  # type: ignore[arg-type]
        try:
            watch(Received(sample, int(tick), 0))
        except Hunting as hunting:
            return float(tick) / 1000 if hunting.joint == 2 else np.inf
    return None


def swing(hertz: float, peak: float) -> np.ndarray:
    return peak * np.sin(2.0 * np.pi * hertz * TICKS / 1000)


REST = np.full(len(TICKS), 0.3)


@pytest.mark.parametrize(("hertz", "every"), [(5.0, 1), (10.0, 1), (10.0, 4)])
def test_a_joint_that_hunts_at_rest_is_stopped_within_a_second(hertz: float, every: int) -> None:
    at = stopped_at(REST, REST + swing(hertz, 0.03), every=every)
    assert at is not None
    assert at < 1.0


def test_small_unrest_is_left_to_the_measures() -> None:
    assert stopped_at(REST, REST + swing(8.0, 0.012)) is None


def test_a_follower_of_a_moving_leader_may_swing() -> None:
    shaken = swing(2.0, 0.3)
    assert stopped_at(shaken, shaken + swing(8.0, 0.05)) is None


def test_an_overshoot_that_dies_out_is_no_hunting() -> None:
    leader = np.where(TICKS < 500, 0.0, 1.0)
    since = np.maximum(TICKS - 500, 0) / 1000
    follower = np.where(TICKS < 500, 0.0, 1.0 - np.exp(-since / 0.15) * np.cos(2 * np.pi * 4 * since))
    assert stopped_at(leader, follower) is None
