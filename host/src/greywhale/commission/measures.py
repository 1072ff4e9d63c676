"""Measures of every joint in a log of the check: error, unrest and ripple at rest, rattling, chatter, voltage.

- error: mean of (leader - follower)², rad²; in the part "holding still" only while the joint's own leader rests.
- unrest, rattle, chatter, ripple: see `measure/swings.py`; rattle only while a hand leads, ripple at rest after
  "moves", where rests are longest.
- voltage: mean of |u|, V.
- overshoot and settling: of the part "moves", by `measure/step_response.py`, % and s; no settling where a step never
  settled.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypedDict, cast

import numpy as np

from greywhale.base.types import Floats, PerJoint
from greywhale.commission.motions import PARTS, Check
from greywhale.files.log import Log
from greywhale.identify.data import at
from greywhale.loop.traces import Traces
from greywhale.measure.runs import REST_RAD, REST_S, resting
from greywhale.measure.step_response import answer, departures, worst
from greywhale.measure.swings import (
    REST_AFTER_S,
    STILL_RAD,
    chatter_of_record,
    rattle_of_record,
    ripple_at_rest,
    unrest,
)
from greywhale.protocol.firmware import JOINTS, TICK_S

LATEST_BEGIN_S = 8.0  # from the first row of a log to the check: the way to its first pose
HOLDING = "holding still"
STEPS = "moves"
HAND_LED = ("reaches", "slow motion")  # parts in which rattling is measured; the others have edges that no hand makes
NAMES = ("error", "unrest", "rattle", "chatter", "ripple", "voltage", "overshoot", "settling")


class PartFacts(TypedDict):
    error: PerJoint[float | None]  # mean squared, rad²
    unrest: PerJoint[float | None]  # swings at rest, rad rms
    rattle: PerJoint[float | None]  # swings in motion, rad rms
    chatter: PerJoint[float | None]  # swings of the voltage, 1/s
    ripple: PerJoint[float | None]  # of the voltage above some 20 Hz, at rest, V rms
    voltage: PerJoint[float | None]  # mean size, V
    overshoot: PerJoint[float | None]  # the largest of the moves, % of the step
    settling: PerJoint[float | None]  # the longest of the moves, s; null where one never settles


@dataclass(frozen=True)
class Measures:
    """(parts, 4) each, NaN where a part was not played to its end or has no such measure; the parts as in PARTS."""

    error: Floats
    unrest: Floats
    rattle: Floats
    chatter: Floats
    ripple: Floats
    voltage: Floats
    overshoot: Floats
    settling: Floats

    @property
    def whole(self) -> bool:
        """True where the check was played to its end."""
        return bool(np.isfinite(self.error).all())

    def worst(self, name: str) -> Floats:
        """The largest of a measure over the parts, (4,); NaN where there is none."""
        values: Floats = getattr(self, name)
        known = np.isfinite(values)
        largest = np.where(known, values, -np.inf).max(axis=0)
        return np.where(known.any(axis=0), largest, np.nan)

    def as_dict(self) -> dict[str, PartFacts]:
        """The facts of each part of the check."""

        def of(name: str, place: int) -> list[float | None]:
            values = getattr(self, name)[place]
            return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values]

        facts = {part: {name: of(name, place) for name in NAMES} for place, part in enumerate(PARTS)}
        return cast("dict[str, PartFacts]", facts)


def traces_of(log: Log, check: Check) -> Traces:
    """A log on an even grid, and where the check begins in it: the leader's columns are the check, some time later."""
    time_s: Floats = np.arange(0.0, float(log.time[-1]), TICK_S)
    leader, follower, voltage = (at(time_s, log.time, values) for values in (log.leader, log.follower, log.voltage))
    return Traces(leader, follower, voltage, _begin(leader, check))


def measure(traces: Traces, check: Check, supply_v: float, *, only_unrest: bool = False) -> Measures:
    """Measure every part that was played to its end; of a search's many, some want nothing but the unrest."""
    found = {name: np.full((len(PARTS), JOINTS), np.nan) for name in NAMES}
    for place, (name, part) in enumerate(check.parts.items()):
        rows = traces.rows(part)
        if rows.stop - rows.start < round((part[1] - part[0]) / TICK_S) - 5:
            continue
        leader, follower, voltage = traces.leader[rows], traces.follower[rows], traces.voltage[rows]
        if name not in HAND_LED:
            found["unrest"][place] = unrest(leader, follower)
        if only_unrest:
            continue
        found["error"][place] = np.mean((leader - follower) ** 2, axis=0)
        if name == HOLDING:
            found["error"][place] = still_error(leader, follower)
        found["voltage"][place] = np.mean(np.abs(voltage), axis=0)
        found["chatter"][place] = chatter_of_record(voltage, supply_v)
        if name == STEPS:
            found["overshoot"][place], found["settling"][place] = step_answers(leader, follower)
            found["ripple"][place] = ripple_at_rest(leader, voltage)
        if name in HAND_LED:
            found["rattle"][place] = rattle_of_record(leader, follower)
    return Measures(**found)


def still_error(leader: Floats, follower: Floats) -> Floats:
    """(4,) rad² while the joint's own leader rests, whatever the other joints do."""
    window = round(REST_AFTER_S / TICK_S)
    rests = [resting(path, window, STILL_RAD) for path in leader.T]
    errors = ((leader - follower) ** 2).T
    return np.array([np.mean(error[rest]) for error, rest in zip(errors, rests, strict=True)])


def step_answers(leader: Floats, follower: Floats) -> tuple[Floats, Floats]:
    """The largest overshoot (%) and the longest settling time (s) of each joint's steps, (4,) each."""
    found = np.full((2, JOINTS), np.nan)
    for joint, (led, followed) in enumerate(zip(leader.T, follower.T, strict=True)):
        rest = resting(led, round(REST_S / TICK_S), REST_RAD)
        answers = [answer(led, followed, rest, step, TICK_S) for step in departures(led, rest, TICK_S)]
        found[:, joint] = [np.nan if one is None else one for one in worst([one for one in answers if one is not None])]
    return found[0], found[1]


def _begin(leader: Floats, check: Check) -> float:
    """The delay (s) at which the check resembles the leader's columns most; coarsely, then to the millisecond."""
    coarse, fine, near, every = 20, 2, 30, 8  # ticks
    latest = min(round(LATEST_BEGIN_S / TICK_S), len(leader)) + coarse
    path = check.motion.at(TICK_S * np.arange(-latest - near, len(leader), dtype=np.float64))
    paths = [np.ascontiguousarray(path[first::every]) for first in range(every)]
    led = np.ascontiguousarray(leader[::every])

    def apart(delay: int) -> float:
        turn, first = divmod(latest + near - delay, every)
        gap = paths[first][turn : turn + len(led)] - led
        return float(np.mean(np.square(gap, out=gap)))

    best = min(range(0, latest, coarse), key=apart)
    return TICK_S * min(range(max(best - near, 0), best + near + 1, fine), key=apart)
