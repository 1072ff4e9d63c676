"""Finds numbers of another unit by what they say: times against the header's facts, and angles that no arm reaches."""

from __future__ import annotations

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.log.held import Numbers
from greywhale.files.log.limits import UNITS
from greywhale.protocol.firmware import TICK_S

# So many times as large as in s is a time in another unit.
TIME_UNITS = {"ms": 1e3, "us": 1e6, "ns": 1e9, "min": 1 / 60, "h": 1 / 3600}


def refuse_other_spacing(name: str, every_ticks: int | None, dropped: int, time_s: Floats) -> None:
    """Refuse times that contradict the header's every_ticks, unless its dropped samples explain what is missing."""
    if every_ticks is None or len(time_s) < UNITS.enough_rows:
        return
    stated = every_ticks * TICK_S
    usual, length = usual_step(time_s), float(time_s[-1] - time_s[0])
    missing = length / stated - len(time_s)
    if UNITS.shorter_ratio <= usual / stated <= UNITS.longer_ratio or (usual > stated and dropped >= missing / 2):
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
    if len(time_s) < UNITS.enough_rows or UNITS.usual_s[0] <= usual <= UNITS.usual_s[1]:
        return ()
    unit = "ms" if usual > UNITS.usual_s[1] else "min"
    return (f"its rows are {_spacing(usual)} apart, which no measure of an arm is made for; is time_s in {unit}?",)


def doubt_speed(time_s: Floats, angles: Floats) -> tuple[str, ...]:
    """Doubts about a motion whose joints all creep, (rows, joints) rad."""
    if np.ptp(angles, axis=0).max() < UNITS.motion_rad:
        return ()
    fastest = float((np.abs(np.diff(angles, axis=0)) / np.diff(time_s)[:, None]).max())
    if fastest >= UNITS.creep_rad_s:
        return ()
    return (f"it takes {time_s[-1] - time_s[0]:.4g} s and never exceeds {fastest:.2g} rad/s; is time_s in ms?",)


def doubt_angles(*angles: Numbers) -> tuple[str, ...]:
    """Doubts about a log that does not say how its potentiometers are scaled, (rows, joints) rad each."""
    largest = max(float(max(one.max(), -one.min())) for one in angles)
    if largest <= UNITS.half_turn_rad:
        return ()
    return (f"its angles reach {largest:.3g} rad, more than half a turn; are they in degrees?",)


def perhaps_degrees(largest: float) -> str:
    """A clause for an angle of so many rad that is out of range: that it may be in degrees, or nothing."""
    return (
        f"; angles reach {largest:.3g}, so they seem to be in degrees"
        if UNITS.turn_rad < largest < UNITS.most_deg
        else ""
    )


def usual_step(time_s: Floats) -> float:
    """The median time between two rows, s."""
    return float(np.median(np.diff(time_s), overwrite_input=True))  # an hour of samples is not copied once more


def _unit_of(ratio: float) -> str:
    """The unit of times that are so many times as large as they should be, or ""."""
    return next(
        (
            unit
            for unit, factor in TIME_UNITS.items()
            if 1 / UNITS.same_unit_ratio < ratio / factor < UNITS.same_unit_ratio
        ),
        "",
    )


def _spacing(seconds: float) -> str:
    return f"{seconds:.4g} s" if seconds >= 0.1 else f"{1e3 * seconds:.4g} ms"
