"""The traces of leader, follower and motors in a motion, measured or simulated, on an even grid."""

from __future__ import annotations

from dataclasses import dataclass

from greywhale.base.types import Floats
from greywhale.protocol.firmware import TICK_S


@dataclass(frozen=True)
class Traces:
    """A played check on an even grid of 1 ms; `begins` is the time (s) at which the check begins in it."""

    leader: Floats  # (rows, 4) rad
    follower: Floats  # (rows, 4) rad
    voltage: Floats  # (rows, 4) V
    begins: float

    def rows(self, part: tuple[float, float]) -> slice:
        first, last = (max(0, round((self.begins + moment) / TICK_S)) for moment in part)
        return slice(min(first, len(self.leader)), min(last, len(self.leader)))
