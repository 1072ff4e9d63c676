"""The delay from leader to follower by two definitions.

`correlation_delay` slides the follower over the leader and takes the lag of highest correlation, refined between
samples by a parabola through the peak. At every lag the mean and scale of exactly the overlapping samples are removed.
So a constant error, a gain, or a window that cuts a motion in half does not move the peak. `onset_delay` is the
paper's definition.
"""

from __future__ import annotations

import numpy as np
import scipy  # loads a part of itself when it is first used
from numpy.typing import NDArray

from greywhale.base.types import Floats
from greywhale.measure.limits import DELAY, STEPS
from greywhale.measure.step_response import Departure

# Samples that are transformed at once, so that a log of an hour needs little memory.
_PIECE = 1 << 16


def correlation_delay(leader: Floats, follower: Floats, period: float) -> float | None:
    """Delay in s, or None: recording too short, motion too small, signals too different, no peak within the search."""
    if np.ptp(leader) < DELAY.least_motion_rad or np.ptp(follower) < DELAY.least_motion_rad:
        return None
    first = -max(2, round(DELAY.before_zero_s / period))
    last = max(2, round(DELAY.longest_s / period))
    if (len(leader) - last) * period < DELAY.shortest_overlap_s:
        return None
    likeness = correlations(leader, follower, first, last)
    best = int(np.argmax(likeness))
    if likeness[best] < DELAY.least_correlation or best in (0, len(likeness) - 1):
        return None
    left, peak, right = likeness[best - 1 : best + 2]
    bend = left - 2.0 * peak + right
    between = 0.5 * (left - right) / bend if bend < 0.0 else 0.0
    return float((first + best + between) * period)


def correlations(leader: Floats, follower: Floats, first: int, last: int) -> Floats:
    """Pearson's correlation of leader[k] and follower[k + lag] over the samples that both have, for every lag."""
    a, b = leader - leader.mean(), follower - follower.mean()
    lags = np.arange(first, last + 1)
    products = _products(a, b, first, last)
    # What a lag leaves out lies at the end of one signal and at the beginning of the other.
    ahead, behind = np.maximum(lags, 0), np.maximum(-lags, 0)
    count = len(a) - np.abs(lags)
    sum_a, sum_b = _sums(a, behind, ahead), _sums(b, ahead, behind)
    largest = np.sqrt(a.dot(a) * b.dot(b))
    spread_a = _sums(np.square(a, out=a), behind, ahead) - sum_a**2 / count
    spread_b = _sums(np.square(b, out=b), ahead, behind) - sum_b**2 / count
    scale = np.sqrt(np.maximum(spread_a, 0.0) * np.maximum(spread_b, 0.0))
    still = scale <= 1e-9 * largest  # what varies so little shows no likeness
    return np.where(still, 0.0, (products - sum_a * sum_b / count) / np.where(still, 1.0, scale))


def _sums(values: Floats, without_first: NDArray[np.intp], without_last: NDArray[np.intp]) -> Floats:
    """Sums of the values without so many first and last ones."""
    most = int(max(without_first.max(), without_last.max()))
    head = np.concatenate(([0.0], np.cumsum(values[:most])))
    tail = np.concatenate(([0.0], np.cumsum(values[::-1][:most])))
    sums: Floats = values.sum() - head[without_first] - tail[without_last]
    return sums


def _products(a: Floats, b: Floats, first: int, last: int) -> Floats:
    """Sums of a[k] b[k + lag] for the lags first..last: pieces of `a` against what they can meet in `b`."""
    span = last - first
    size = scipy.fft.next_fast_len(_PIECE + span, real=True)
    sums = np.zeros(span + 1)
    for start in range(0, len(a), _PIECE):
        piece = a[start : start + _PIECE]
        low, high = start + first, start + len(piece) + last
        met = np.zeros(high - low)
        inside = slice(max(low, 0), min(high, len(b)))
        met[inside.start - low : inside.stop - low] = b[inside]
        sums += scipy.fft.irfft(np.conj(scipy.fft.rfft(piece, size)) * scipy.fft.rfft(met, size), size)[: span + 1]
    return sums


def onset_delay(leader: Floats, follower: Floats, step: Departure, rest_samples: int) -> float | None:
    """The paper's time delay of a step that the leader makes out of a rest, in samples; None where nothing answers.

    An onset is the first time an angle is further than `onset_rad` from where it rested, in the direction of the step;
    it lies between two samples, and is interpolated. The follower's onset is looked for until the leader's next rest
    has ended.
    """
    # The follower may still be settling when the leader leaves, so its place of rest is its last place.
    moved = leader[step.end : step.limit] - step.begin
    answered = follower[step.end : step.limit] - np.median(follower[step.end - rest_samples // 10 : step.end + 1])
    command, answer = (_crossing(step.side * angles, STEPS.onset_rad) for angles in (moved, answered))
    return None if command is None or answer is None else answer - command


def _crossing(value: Floats, level: float) -> float | None:
    """Return the place where `value` first rises above `level`, in samples, interpolated."""
    above = np.flatnonzero(value > level)
    if not above.size:
        return None
    after = int(above[0])
    if after == 0:
        return 0.0
    low, high = value[after - 1], value[after]
    return float(after - 1 + (level - low) / (high - low))
