"""Where the set may change: at a rest of leader and follower, close to each other."""

from __future__ import annotations

import pytest

from greywhale.adapt.change import RestWatch
from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.board.stream import Received
from greywhale.protocol import schema
from greywhale.protocol.firmware import ANGLE_LSB

LIMITS = ADAPTATION_LIMITS.changes


def watch(leader_rad: float, follower_rad: float, moves_rad: float, count: int = LIMITS.rest_samples) -> RestWatch:
    """After samples in which joint 2's leader goes evenly over `moves_rad`, its follower always as far behind."""
    watching = RestWatch()
    for number in range(count):
        gone = moves_rad * number / count
        leads, follows = (round((angle + gone) / ANGLE_LSB) for angle in (leader_rad, follower_rad))
        rest = schema.State.FOLLOWING, schema.Fault.NONE, (0, 0, leads, 0), (0, 0, follows, 0), (0, 0, 0, 0)
        watching.take(Received(schema.Sample(number, *rest), number, 0))
    return watching


@pytest.mark.parametrize(
    ("watching", "resting"),
    [
        (watch(0.3, 0.25, 0.0), True),
        (watch(0.3, 0.25, 0.8 * LIMITS.still_rad), True),
        (watch(0.3, 0.25, 1.5 * LIMITS.still_rad), False),
        (watch(0.3, 0.3 - 1.2 * LIMITS.close_rad, 0.0), False),
        (watch(0.3, 0.25, 0.0, LIMITS.rest_samples - 20), False),
    ],
)
def test_a_rest_is_still_and_close_for_a_while(watching: RestWatch, resting: bool) -> None:
    assert watching.resting == resting


def test_the_error_is_the_largest_of_all_joints() -> None:
    assert watch(0.3, 0.1, 0.0).error == pytest.approx(0.2, abs=1e-3)
