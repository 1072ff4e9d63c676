"""Finds the rows of a log with motors at work, and the joints that had no voltage that could have moved them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from greywhale.files.log.layout import STATES
from greywhale.files.log.limits import MOTORS
from greywhale.files.log.reader import Log
from greywhale.protocol.firmware import JOINTS

_RECORD = "record with `greywhale record --enable`"
_REMEDIES = {
    "fault": "`greywhale info` names the fault; clear it, then record again",
    "following": "check that the voltage columns hold what moved the motors",
}


def following_rows(log: Log) -> NDArray[np.bool_]:
    """The rows (rows,) in which the motors followed; all of a log that has none, such as one of another tool."""
    following = log.following
    return following if following.any() else np.ones(len(log.time), dtype=bool)


def driven_rows(log: Log) -> NDArray[np.bool_]:
    """The following rows; in a log that has none, the rows near a voltage, since the motors were off elsewhere."""
    some = np.zeros(len(log.time), dtype=bool)
    volts = log.held("voltage")
    for joint in range(JOINTS):  # one after another: a log of an hour is large
        some |= np.abs(volts[:, joint]) >= MOTORS.least_v
    powered = np.flatnonzero(some)
    if not powered.size or log.following.any():
        return following_rows(log)
    after = np.searchsorted(powered, np.arange(len(log.time)))
    times = log.time[powered]
    late = log.time - times[np.maximum(after - 1, 0)]
    early = times[np.minimum(after, len(powered) - 1)] - log.time
    return ((late >= 0.0) & (late <= MOTORS.off_s)) | ((early >= 0.0) & (early <= MOTORS.off_s))


def as_slice(rows: NDArray[np.bool_]) -> slice | NDArray[np.bool_]:
    """Rows that are one stretch as a slice, which copies nothing of a long log."""
    begin, end = int(rows.argmax()), len(rows) - int(rows[::-1].argmax())
    return slice(begin, end) if rows[begin:end].all() else rows


def undriven(log: Log, rows: NDArray[np.bool_]) -> tuple[int, ...]:
    """The joints in use whose voltage is the same in all these rows."""
    some = rows.any()
    least = MOTORS.least_v
    return tuple(joint for joint in log.joints_in_use if not some or _range(log, "voltage", rows, joint) < least)


def tell_off(log: Log) -> str:
    """That no joint had a voltage, with the cause and what to do, in a clause that follows the log's name; "" where
    one had.
    """
    rows = driven_rows(log)
    if undriven(log, rows) != log.joints_in_use:
        return ""
    states = [STATES[place] for place in dict.fromkeys(log.places[rows].tolist())]
    volts = _volts(log, rows, log.joints_in_use[0])
    off = "following" not in states and volts == "0 V"
    cause = "the motors were off" if off else "no motor's voltage changes"
    remedy = next((text for state, text in _REMEDIES.items() if state in states), _RECORD)
    return (
        f"{cause} in all {log.time[-1] - log.time[0]:.3g} s (state {' and '.join(states)}, {volts}), so it does not "
        f"show how voltages move the arm; {remedy}"
    )


def tell_undriven(log: Log, rows: NDArray[np.bool_]) -> dict[int, str]:
    """A clause for each single joint that moved or was led in these rows without a voltage."""
    clauses = {}
    for joint in undriven(log, rows):
        led, moved = (_range(log, name, rows, joint) for name in ("leader", "follower"))
        if max(led, moved) > MOTORS.motion_rad:
            clauses[joint] = (
                f"joint {joint} had {_volts(log, rows, joint)} in every row, while its leader moved by {led:.2g} rad "
                f"and its follower by {moved:.2g} rad: check its motor's wires and its voltage column"
            )
    return clauses


def tell_powerless(log: Log) -> list[str]:
    """Either, for whoever only measures a log: clauses that follow its name."""
    off = tell_off(log)
    return [off] if off else list(tell_undriven(log, following_rows(log)).values())


def _volts(log: Log, rows: NDArray[np.bool_], joint: int) -> str:
    volts = log.held("voltage")[rows, joint]
    return f"{round(float(np.median(volts)), 2) + 0.0:g} V"


def _range(log: Log, quantity: str, rows: NDArray[np.bool_], joint: int) -> float:
    return float(np.ptp(log.held(quantity)[rows, joint]))
