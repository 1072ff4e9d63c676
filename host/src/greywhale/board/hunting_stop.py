"""Watches a follower while it is led, and stops it at once when a joint hunts.

A joint hunts here when it turns back again and again, each time by more than a swing that nobody can overlook, while
its leader rests. Smaller unrest is measured afterwards, in the whole log.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from greywhale.board.limits import HUNTING
from greywhale.board.stream import Received
from greywhale.measure.swings import VIOLENT, turns_of
from greywhale.protocol.firmware import ANGLE_LSB


class Hunting(Exception):
    """A joint hunts, and the motors went off."""

    def __init__(self, joint: int) -> None:
        super().__init__(f"joint {joint} hunts")
        self.joint = joint


class HuntingStop:
    """Call it with every sample; it raises Hunting."""

    def __init__(self) -> None:
        self._last: deque[Received] = deque()
        self._count = 0

    def __call__(self, received: Received) -> None:
        self._last.append(received)
        while received.elapsed - self._last[0].elapsed > 1000 * (HUNTING.window_s + HUNTING.settle_s):
            self._last.popleft()
        self._count += 1
        if self._count % HUNTING.look_every_samples == 0:
            self._look()

    def _look(self) -> None:
        leader = np.array([one.sample.leader for one in self._last]) * ANGLE_LSB
        follower = np.array([one.sample.follower for one in self._last]) * ANGLE_LSB
        judged = np.array([one.elapsed for one in self._last]) > self._last[-1].elapsed - 1000 * HUNTING.window_s
        turned = turns_of(follower[judged], VIOLENT.band_rad)
        hunting = (turned >= VIOLENT.turns) & (np.ptp(leader, axis=0) <= HUNTING.still_rad)
        if hunting.any():
            raise Hunting(int(np.argmax(np.where(hunting, turned, 0))))
