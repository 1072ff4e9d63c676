"""A leader motion: time stamps and four joint angles, and the smooth curve through them.

Recordings come at 50 Hz or so, while the simulated converter looks thousands of times a second. Between the
rows the motion is a monotone cubic (PCHIP): smooth like a hand, never beyond the two rows it joins, so never
out of range.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from greywhale.base.types import Floats
from greywhale.protocol.firmware import JOINTS

POT_RANGE_RAD = (
    2.4  # a 300 degree potentiometer covers +-2.62 rad; its last few degrees are the rails that mean a broken wire
)


@dataclass(frozen=True)
class Trajectory:
    """Leader angles `angles[row, joint]` in rad at `time_s[row]`, which starts at 0 and strictly increases.

    `remarks` are sentences about the file that it is from, for whoever plays it.
    """

    time_s: Floats
    angles: Floats
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        rows = len(self.time_s)
        if rows < 2 or self.angles.shape != (rows, JOINTS):
            raise ValueError(
                f"a trajectory needs two or more rows of {JOINTS} angles, got {self.angles.shape} for {rows} times"
            )
        if self.time_s[0] != 0.0 or not np.all(np.diff(self.time_s) > 0.0):
            raise ValueError("the times of a trajectory must start at 0 and strictly increase")
        if not np.all(np.abs(self.angles) <= POT_RANGE_RAD):  # false for nan as well
            raise ValueError(f"the angles of a trajectory must lie in [-{POT_RANGE_RAD}, {POT_RANGE_RAD}] rad")

    @property
    def duration_s(self) -> float:
        return float(self.time_s[-1])

    @cached_property
    def _curve(self) -> Callable[[Floats], Floats]:
        from scipy.interpolate import PchipInterpolator  # slow to import, and needed only once a motion is played

        curve: Callable[[Floats], Floats] = PchipInterpolator(self.time_s, self.angles, axis=0)
        return curve

    def at(self, time_s: Floats) -> Floats:
        """The angles at any times: the first pose before the start, the last pose after the end."""
        return np.asarray(self._curve(np.clip(time_s, 0.0, self.duration_s)), dtype=np.float64)
