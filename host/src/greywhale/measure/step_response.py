"""Steps of the leader out of a rest, and how the follower answers them: overshoot and settling time.

- A step begins where a rest of the leader ends and the leader then gets further than `step_rad` within `step_s`, to one
  side. It counts here if the leader rests again, at least `step_rad` away from where it was.
- Overshoot: how far the follower gets beyond the leader's new place, in per cent of the step.
- Settling time: from when the leader is in the band around its new place for good until the follower is, until the
  leader's next departure. The band is 5 % of the step to either side, but at least REST_RAD. A leader that jumps
  is there at once, so that this is the usual time since the step. A hand's own way is not counted.

Angles are smoothed over 20 ms, so that single noisy samples are no overshoot.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of itself when it is first used
from numpy.typing import NDArray

from greywhale.base.types import Floats
from greywhale.measure.limits import STEPS
from greywhale.measure.runs import REST_RAD, REST_S, periods

Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Departure:
    """A step: row `end` is the last of the leader's rest, at `begin` rad; `limit` is one row behind its next rest."""

    end: int
    limit: int
    begin: float
    side: float  # 1: up, -1: down


@dataclass(frozen=True)
class StepResponse:
    """The follower's answer to one step; it never settled where `settling_s` is None."""

    overshoot_percent: float
    settling_s: float | None


def departures(leader: Floats, rest: Bools, period: float) -> Iterator[Departure]:
    """Every step of the leader out of a rest."""
    rested, within = (periods(seconds, period) for seconds in (REST_S, STEPS.step_s))
    ends = np.flatnonzero(rest[:-1] & ~rest[1:])
    for index, end in enumerate(ends):
        limit = int(ends[index + 1]) + 1 if index + 1 < len(ends) else len(leader)
        begin = float(np.median(leader[end - rested : end + 1]))
        moved = leader[end:limit] - begin
        away = np.flatnonzero(np.abs(moved) > STEPS.onset_rad)
        if not away.size:
            continue
        side = float(np.sign(moved[away[0]]))
        if (side * moved[away[0] : away[0] + within]).max() >= STEPS.step_rad:
            yield Departure(int(end), limit, begin, side)


def answer(leader: Floats, follower: Floats, rest: Bools, step: Departure, period: float) -> StepResponse | None:
    """The follower's answer to a step, or None where the leader does not rest again, or too near to where it was."""
    arrived = np.flatnonzero(rest[step.end + 1 : step.limit])
    if not arrived.size:
        return None
    place = float(np.median(leader[step.end + 1 + int(arrived[0]) : step.limit]))
    moved = step.side * (place - step.begin)
    if moved < STEPS.step_rad:
        return None
    here, size = slice(step.end, step.limit), max(1, round(STEPS.smooth_s / period))
    led, followed = (
        scipy.ndimage.uniform_filter1d(angles[here], size, mode="nearest") for angles in (leader, follower)
    )
    band = max(STEPS.settled_share * moved, REST_RAD)
    there, settled = (_last(np.abs(angles - place) > band) for angles in (led, followed))
    # At the end of its rest the leader already moves on, perhaps to the same side.
    beyond = np.minimum(step.side * (followed - place), step.side * (followed - led))
    never = settled == len(followed) - 1
    return StepResponse(
        overshoot_percent=100.0 * max(0.0, float(beyond.max())) / moved,
        settling_s=None if never else max(0, settled - there) * period,
    )


def worst(answers: Sequence[StepResponse]) -> tuple[float | None, float | None]:
    """The largest overshoot and the longest settling time; the latter is None where one never settled."""
    if not answers:
        return None, None
    settled = [one.settling_s for one in answers if one.settling_s is not None]
    longest = max(settled) if len(settled) == len(answers) else None
    return max(one.overshoot_percent for one in answers), longest


def _last(outside: Bools) -> int:
    """The last row that is, or -1."""
    rows = np.flatnonzero(outside)
    return int(rows[-1]) if rows.size else -1
