"""A record of one joint: what led it, what drove it, where it was; and the pieces of it that are simulated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from greywhale.base.errors import BAD_USAGE, UserError
from greywhale.base.types import Floats

# Start angle and speed of a piece come from a parabola through so many seconds before it: the past only.
START_S = 0.05


@dataclass(frozen=True)
class Record:
    """One joint's log, a number a row each: s, rad, V at the motor, N m on the link from outside.

    `leader_lines` and `volts_lines`: the signal goes straight from row to row; otherwise it holds until the next.
    `resolution`: step of a reading, rad.
    """

    name: str
    time: Floats
    leader: Floats
    follower: Floats
    volts: Floats
    load: Floats
    leader_lines: bool = True
    volts_lines: bool = True
    resolution: float = 0.0

    def __post_init__(self) -> None:
        for name in ("leader", "follower", "volts", "load"):
            values = getattr(self, name)
            if values.shape != self.time.shape or not np.isfinite(values).all():
                raise UserError(f"{self.name}: {name} must hold a finite number for each of {len(self.time)} rows.", 2)
        if len(self.time) < 20 or (np.diff(self.time) <= 0.0).any():
            raise UserError(f"{self.name}: at least 20 rows with rising times are needed.", BAD_USAGE)

    @property
    def spacing(self) -> Floats:
        """From each row to the next, s; the last is taken to be as long as a usual one."""
        return np.diff(self.time, append=self.time[-1] + float(np.median(np.diff(self.time))))

    @property
    def middle(self) -> int:
        """The first row of the second half (by time)."""
        return int(np.searchsorted(self.time, 0.5 * (self.time[0] + self.time[-1])))

    def until(self, row: int) -> Record:
        """The record up to a row."""
        columns = {name: getattr(self, name)[:row] for name in ("time", "leader", "follower", "volts", "load")}
        return replace(self, **columns)

    def start(self, row: int) -> tuple[float, float]:
        """Angle and speed at a row, of that and the rows before: by a parabola, or a line where readings are coarse."""
        first = min(int(np.searchsorted(self.time, self.time[row] - self._start_s(), side="left")), max(0, row - 3))
        if row - first < 3:
            return float(self.follower[row]), 0.0
        time = self.time[first : row + 1] - self.time[row]
        fitted = np.polyfit(time, self.follower[first : row + 1], 1 if self.resolution else 2)
        return float(fitted[-1]), float(fitted[-2])

    def _start_s(self) -> float:
        """Coarse readings need a longer line: at a usual speed, some steps of the converter."""
        if self.resolution == 0.0:
            return START_S
        usual = float(np.percentile(np.abs(np.gradient(self._smooth(), self.time)), 75))
        return float(np.clip(3.0 * self.resolution / max(usual, 1e-6), START_S, 4.0 * START_S))

    def _smooth(self) -> Floats:
        width = max(1, round(4.0 * START_S / float(np.median(np.diff(self.time)))))
        padded = np.pad(self.follower, (width, width), mode="edge")
        smooth: Floats = np.convolve(padded, np.ones(width) / width, mode="same")[width:-width]
        return smooth


@dataclass(frozen=True)
class Pieces:
    """Rows where simulations start, all of one length, with angle and speed there."""

    first: NDArray[np.int64]
    rows: int
    angles: Floats
    velocities: Floats


def pieces_of(record: Record, begin: int, end: int, length_s: float | None = None) -> Pieces:
    """Pieces of so many seconds one after the other in rows [begin, end), or all of it as one."""
    rows = end - begin
    if length_s is not None:
        rows = min(rows, max(2, round(length_s / float(np.median(np.diff(record.time))))))
    first = np.arange(begin, end - rows + 1, rows, dtype=np.int64)
    starts = np.array([record.start(int(row)) for row in first])
    return Pieces(first, rows, np.ascontiguousarray(starts[:, 0]), np.ascontiguousarray(starts[:, 1]))
