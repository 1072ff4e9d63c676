"""A leader motion on the closed loop's clock: an even recording as it is, one with gaps only on request."""

from __future__ import annotations

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.firmware import TICK_S

SLICES_PER_TICK = 4
SLICE_S = TICK_S / SLICES_PER_TICK


def leader_slices(motion: Trajectory, wait_s: float, resample: bool = False) -> Floats:
    """Leader angles (rad) in every slice of 250 us: first pose for `wait_s`, then the motion.

    Between the rows of an even recording runs its monotone cubic (greywhale.measure). A recording with gaps or
    uneven times is refused, unless `resample` allows the same cubic to bridge them too.
    """
    if not resample:
        _require_even(motion)
    ticks = int(np.ceil((wait_s + motion.duration_s) / (SLICES_PER_TICK * SLICE_S) - 1e-9))
    times = np.arange(ticks * SLICES_PER_TICK, dtype=np.float64) * SLICE_S - wait_s
    return np.ascontiguousarray(motion.at(times))


def straight_slices(rows: Floats, apart: int, wait_s: float) -> Floats:
    """Leader angles (rad) in every slice: first row for `wait_s`, then straight lines between rows (n, 4) that are
    `apart` slices from each other. A page makes them from the same few numbers, to the bit.
    """
    wait = round(wait_s / SLICE_S)
    ticks = int(np.ceil((wait + (len(rows) - 1) * apart) / SLICES_PER_TICK))
    at = np.maximum(np.arange(ticks * SLICES_PER_TICK) - wait, 0)
    row = np.minimum(at // apart, len(rows) - 2)
    share = np.minimum((at - row * apart) / apart, 1.0)[:, None]
    angles: Floats = rows[row] + share * (rows[row + 1] - rows[row])
    return angles


def _require_even(motion: Trajectory) -> None:
    spacing = np.diff(motion.time_s)
    usual = float(np.median(spacing))
    off = np.flatnonzero(np.abs(spacing - usual) > 0.05 * usual)  # rows may be a little early or late
    if off.size:
        row = int(off[0])
        kind = "a gap" if spacing[row] > 1.5 * usual else "uneven time"
        raise UserError(
            f"the leader motion has {kind}: {motion.time_s[row + 1]:g} s follows {motion.time_s[row]:g} s, "
            f"elsewhere rows are {usual:g} s apart; record it again, or ask for resampling (resample=True)."
        )
