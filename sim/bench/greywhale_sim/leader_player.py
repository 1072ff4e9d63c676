"""The person at the bench, with a motion to play (sim/bench/person.h says what a person does)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from greywhale import _native
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.joints import ALL, Joints

Place = tuple[Floats | None, Floats | None, float]  # of leader and follower, None: where it is; seconds on the way

START_S = 1.5  # from enable to the first movement: the soft start takes 1 s
LET_GO_S = 0.5  # from motors off to the hand on the follower
BRING_BACK_S = 1.0  # from where the arms are to the first pose


class LeaderPlayer(_native.Person):
    """Leader angles for every slice; `hold` is the pose in which the hand holds the follower, None when it is free.

    Joints that are not in use stay at 0, whatever the motion and the hands want.
    """

    def __init__(self, motion: Trajectory, slice_s: float, start_s: float = START_S, joints: Joints = ALL) -> None:
        super().__init__(*_rows(motion, slice_s), slice_s, start_s, sum(1 << joint for joint in joints))
        self._slice_s = slice_s

    def take_up(self, motion: Trajectory) -> None:
        """Play another motion, from its first pose on: at work now, else from the next enable on."""
        self.take_up_rows(*_rows(motion, self._slice_s))

    def bring(self, leader: Floats | None, follower: Floats | None, seconds: float) -> None:
        """Bring a held arm, or both, to angles (4,) rad within so many seconds; both are held until the next enable."""
        self.bring_along([(leader, follower, seconds)])

    def bring_along(self, places: Sequence[Place]) -> None:
        """Bring held arms to one place after another."""
        self.require_held()
        self.bring_slices([(leader, follower, round(seconds / self._slice_s)) for leader, follower, seconds in places])

    def require_held(self) -> None:
        if self.hold is None:
            raise UserError("the hands are on the arms only while the motors are off; stop them first.")


def _rows(motion: Trajectory, slice_s: float) -> tuple[int, Callable[[int, int], Floats]]:
    """The rows of a motion, one for each slice, and what reads them."""

    def read(first: int, count: int) -> Floats:
        return np.ascontiguousarray(motion.at(np.arange(first, first + count, dtype=np.float64) * slice_s))

    return math.ceil(motion.duration_s / slice_s) + 1, read
