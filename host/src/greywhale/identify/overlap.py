"""Finds samples that two logs share: a copy, or a cut with another start of time, says nothing that its log did not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from greywhale.base.errors import BadUsage
from greywhale.base.types import Floats
from greywhale.files.log import Log
from greywhale.identify.limits import IDENTIFICATION_LIMITS, IdentificationLimits
from greywhale.measure.runs import stretches

# So many rows one after another are not the same by chance (a power of two). At rest they may be: only stretches in
# which the arm moves count.
_RUN = 32
_FACTOR = 0x9E3779B97F4A7C15  # odd, of 64 bits


def refuse_shared(
    fit: Sequence[Log], validate: Sequence[Log], judging: IdentificationLimits = IDENTIFICATION_LIMITS
) -> None:
    """Refuse logs of which one holds the samples of another: each may be fitted once, and none validated that was."""
    for place, log in enumerate(fit):
        for other in fit[:place]:
            if shares_samples(other, log, judging):
                raise BadUsage(
                    f"{_both(other, log)}; what is fitted twice counts twice. Give one of them, or record another log."
                )
    for log in validate:
        for other in fit:
            if shares_samples(other, log, judging):
                raise BadUsage(
                    f"{_both(other, log)}; a model is validated on a log that it was not fitted to. Record another one."
                )


def shares_samples(one: Log, other: Log, judging: IdentificationLimits = IDENTIFICATION_LIMITS) -> bool:
    """True where the logs hold the same samples, all or a good part of them, whatever their clocks say."""
    if one is other:
        return True
    short, long = sorted((_rows(one), _rows(other)), key=len)
    if np.array_equal(short, long):
        return True
    if len(short) < _RUN:
        return False
    starts = np.flatnonzero(np.isin(_hash_runs(short), _hash_runs(long)))
    shared = np.zeros(len(short) + 1, dtype=np.int64)
    np.add.at(shared, starts, 1)
    np.add.at(shared, starts + _RUN, -1)
    lively = _count_lively(short, np.cumsum(shared)[:-1] > 0, judging.data.lively_rad)
    return lively > judging.checks.max_shared * len(short)


def _both(one: Log, other: Log) -> str:
    if one.name == other.name:
        return f"{one.name} is given twice"
    return f"{one.name} and {other.name} hold the same samples"


def _rows(log: Log) -> Floats:
    """All quantities of a sample but its time, (rows, 12)."""
    return np.column_stack([log.leader, log.follower, log.voltage]) + 0.0  # -0 and 0 are one number


def _hash_runs(rows: Floats) -> NDArray[np.uint64]:
    """A number for every run of rows, by what it holds: (rows - _RUN + 1,)."""
    bits = np.ascontiguousarray(rows).view(np.uint64)
    factor = _FACTOR
    found = np.zeros(len(bits), dtype=np.uint64)
    for column in bits.T:
        found = (found ^ column) * np.uint64(_FACTOR)
        found ^= found >> np.uint64(29)
    size = 1
    while size < _RUN:
        found = found[:-size] * np.uint64(factor) + found[size:]
        factor = factor * factor % (1 << 64)
        size *= 2
    return found


def _count_lively(rows: Floats, shared: NDArray[np.bool_], lively_rad: float) -> int:
    """Count the rows that lie in shared stretches in which a follower's joint moves."""
    joints = rows.shape[1] // 3
    return sum(
        stop - start
        for start, stop in stretches(shared)
        if np.ptp(rows[start:stop, joints : 2 * joints], axis=0).max() > lively_rad
    )
