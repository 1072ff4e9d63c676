"""Gap-free runs of samples, and where in a run a joint rests."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is first used
from numpy.typing import NDArray

# Rows that are filtered at once, so that a log of an hour needs little memory.
_PART = 1 << 18
# A leader rests that has stayed within the band (rad) for so long (s).
REST_S, REST_RAD = 0.5, 0.02


@dataclass(frozen=True)
class Run:
    """Samples start..stop-1, evenly spaced by `period` seconds (to within clock rounding)."""

    start: int
    stop: int
    period: float

    @property
    def slice(self) -> slice:
        return slice(self.start, self.stop)

    def samples(self, seconds: float) -> int:
        """Count the sampling periods that `seconds` takes, rounded up."""
        return periods(seconds, self.period)


def periods(seconds: float, period: float) -> int:
    """Count the periods (s) in `seconds`, rounded up; at least one, however long a period is."""
    return max(1, math.ceil(seconds / period - 1e-9))


def stretches(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the stretches where the mask is true: the first row of each, and the first behind it."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(np.int8)))
    return [(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def gap_free_runs(time: NDArray[np.float64], wanted: NDArray[np.bool_], no_gap_s: float = 0.0) -> list[Run]:
    """The runs of at least two neighbouring wanted samples, between which nothing is missing.

    In any case samples within `no_gap_s` are neighbours.
    """
    most = max(1.5 * float(np.median(np.diff(time), overwrite_input=True)), no_gap_s)  # beyond, samples were lost
    joined = (np.diff(time) <= most) & wanted[1:] & wanted[:-1]
    return [Run(start, stop + 1, float(time[stop] - time[start]) / (stop - start)) for start, stop in stretches(joined)]


def resting(angle: NDArray[np.float64], window: int, band: float) -> NDArray[np.bool_]:
    """True where the angle has stayed within `band` (highest minus lowest) during the last `window` periods."""
    rest = np.zeros(len(angle), dtype=bool)
    size = window + 1
    if len(angle) < size:
        return rest
    # The filters are centred. Shifting their origin makes them look only backwards, so a long log is filtered by parts.
    origin = window // 2
    for begin in range(window, len(angle), _PART):
        part = angle[begin - window : begin + _PART]
        highest = scipy.ndimage.maximum_filter1d(part, size, origin=origin)
        lowest = scipy.ndimage.minimum_filter1d(part, size, origin=origin)
        rest[begin : begin + _PART] = (highest - lowest)[window:] <= band
    return rest


def last_part(rest: NDArray[np.bool_], window: int) -> NDArray[np.bool_]:
    """Of each rest, the last `window` samples at most."""
    ends = rest & ~np.append(rest[1:], False)
    near_end: NDArray[np.bool_] = scipy.ndimage.maximum_filter1d(ends, window, origin=-(window // 2), mode="constant")
    return rest & near_end


def first_part(rest: NDArray[np.bool_], window: int) -> NDArray[np.bool_]:
    """The rest with which a record begins: it is known to rest from row `window` on."""
    begun: NDArray[np.bool_] = np.logical_and.accumulate(rest[window:])
    return np.concatenate((np.zeros(min(window, len(rest)), dtype=bool), begun))
