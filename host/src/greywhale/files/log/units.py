"""Finds numbers of another unit by what they say: times against the header's facts, and angles that no arm reaches."""

from __future__ import annotations

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.log.held import Numbers
from greywhale.protocol.firmware import TICK_S

# So many times as large as in s is a time in another unit.
TIME_UNITS = {"ms": 1e3, "us": 1e6, "ns": 1e9, "min": 1 / 60, "h": 1 / 3600}
# Fewer rows may be apart as they like, by chance.
_ENOUGH_ROWS = 50
# How far the usual time between rows may be from what the header says, as a factor.
_LONGER_RATIO, _SHORTER_RATIO = 1.5, 0.7
_SAME_UNIT_RATIO = 1.05  # so far a spacing may be from another unit's and still be in it
# Rows of a log are usually between these, s: no arm is seen at longer ones, and no board is quicker.
USUAL_S = (2e-4, 0.2)
# A motion of more than this (rad) that never exceeds this speed (rad/s) is a thousandth of what a hand does.
_MOTION_RAD, _CREEP_RAD_S = 0.1, 0.02
# Few joints turn further than this from their zero, rad.
_HALF_TURN_RAD = 3.15
# Angles beyond a turn are degrees rather than rad, if they are below this.
_TURN_RAD, _MOST_DEG = 6.3, 1000.0


def refuse_other_spacing(name: str, every_ticks: int | None, dropped: int, time_s: Floats) -> None:
    """Refuse times that contradict the header's every_ticks, unless its dropped samples explain what is missing."""
    if every_ticks is None or len(time_s) < _ENOUGH_ROWS:
        return
    stated = every_ticks * TICK_S
    usual, length = usual_step(time_s), float(time_s[-1] - time_s[0])
    missing = length / stated - len(time_s)
    if _SHORTER_RATIO <= usual / stated <= _LONGER_RATIO or (usual > stated and dropped >= missing / 2):
        return
    unit = _unit_of(usual / stated)
    cause = "take the log as it was recorded, or correct its header"
    if unit:
        cause = f"is time_s in {unit}? Times are in s"
    raise UserError(
        f"{name}: its rows are {_spacing(usual)} apart, but by its header (every_ticks {every_ticks}, "
        f"dropped_samples {dropped}) they should be {_spacing(stated)} apart: {cause}."
    )


def doubt_spacing(time_s: Floats) -> tuple[str, ...]:
    """A doubt about the times of a log whose header says nothing of them, as a sentence that follows its name."""
    usual = usual_step(time_s)
    if len(time_s) < _ENOUGH_ROWS or USUAL_S[0] <= usual <= USUAL_S[1]:
        return ()
    unit = "ms" if usual > USUAL_S[1] else "min"
    return (f"its rows are {_spacing(usual)} apart, which no measure of an arm is made for; is time_s in {unit}?",)


def doubt_speed(time_s: Floats, angles: Floats) -> tuple[str, ...]:
    """Doubts about a motion whose joints all creep, (rows, joints) rad."""
    if np.ptp(angles, axis=0).max() < _MOTION_RAD:
        return ()
    fastest = float((np.abs(np.diff(angles, axis=0)) / np.diff(time_s)[:, None]).max())
    if fastest >= _CREEP_RAD_S:
        return ()
    return (f"it takes {time_s[-1] - time_s[0]:.4g} s and never exceeds {fastest:.2g} rad/s; is time_s in ms?",)


def doubt_angles(*angles: Numbers) -> tuple[str, ...]:
    """Doubts about a log that does not say how its potentiometers are scaled, (rows, joints) rad each."""
    largest = max(float(max(one.max(), -one.min())) for one in angles)
    if largest <= _HALF_TURN_RAD:
        return ()
    return (f"its angles reach {largest:.3g} rad, more than half a turn; are they in degrees?",)


def perhaps_degrees(largest: float) -> str:
    """A clause for an angle of so many rad that is out of range: that it may be in degrees, or nothing."""
    return f"; angles reach {largest:.3g}, so they seem to be in degrees" if _TURN_RAD < largest < _MOST_DEG else ""


def usual_step(time_s: Floats) -> float:
    """The median time between two rows, s."""
    return float(np.median(np.diff(time_s), overwrite_input=True))  # an hour of samples is not copied once more


def _unit_of(ratio: float) -> str:
    """The unit of times that are so many times as large as they should be, or ""."""
    return next(
        (unit for unit, factor in TIME_UNITS.items() if 1 / _SAME_UNIT_RATIO < ratio / factor < _SAME_UNIT_RATIO), ""
    )


def _spacing(seconds: float) -> str:
    return f"{seconds:.4g} s" if seconds >= 0.1 else f"{1e3 * seconds:.4g} ms"
