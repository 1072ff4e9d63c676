"""A leader that is sent angles again and again: it goes there smoothly, and no faster than hands are."""

from __future__ import annotations

import numpy as np

from greywhale.base.types import Floats

# A critically damped pull: nine tenths of a short way take 0.16 s. No hand turns a joint faster than the other.
PULL_PER_S, FASTEST_RAD_S = 25.0, 5.0


class StreamedLeader:
    """`angles` (4,) rad follow `target` from slice to slice."""

    def __init__(self, angles: Floats) -> None:
        self.target = angles.copy()
        self.take(angles)

    def take(self, angles: Floats) -> None:
        """Begin anew from where the arm is."""
        self.angles = angles.copy()
        self._speeds = [0.0] * len(angles)

    def step(self, slice_s: float) -> None:
        angles, speeds = self.angles.tolist(), self._speeds
        for joint, target in enumerate(self.target.tolist()):  # quicker than array arithmetic on so few numbers
            pull = PULL_PER_S * PULL_PER_S * (target - angles[joint]) - 2.0 * PULL_PER_S * speeds[joint]
            speeds[joint] = min(max(speeds[joint] + slice_s * pull, -FASTEST_RAD_S), FASTEST_RAD_S)
            angles[joint] += slice_s * speeds[joint]
        self.angles = np.array(angles)
