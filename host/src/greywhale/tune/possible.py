"""The room in every class of training motion, from the least error to that of the controllers from before.

The least error is that of the ideal controller of `judge/floor.py`, which hears of the leader as late as a board does.
It is worked out for every plant, once for each tuning. A joint may start at its floor, or so near to it that a division
by the rest would magnify mere noise. So the room of a class is never less than `least_room_share` of its floor, and
never less than `least_room_rad`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greywhale import _native
from greywhale.base.limits import numbers_in
from greywhale.base.types import Controllers, Floats
from greywhale.identify.data import CONVERSION_S
from greywhale.protocol.firmware import TICK_S
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.floor import follow_ideally
from greywhale.tune.limits import TUNING_LIMITS, TuningLimits
from greywhale.tune.search.objective import ErrorScale, follow
from greywhale.tune.search.training import WAIT_S, TrainingMotion


def scale_of(
    drills: Sequence[TrainingMotion],
    plants: Floats,
    before: Controllers,
    threads: int = 0,
    judging: TuningLimits = TUNING_LIMITS,
) -> ErrorScale:
    """Floors, and errors and rattling of the controllers from before (4, 13), on every plant."""
    late = lateness_s(drills[0].experiment.table)
    floor = np.stack([_least_errors(drill, plants, late, threads, judging) for drill in drills], axis=1)
    found = follow(drills, plants, before[None], threads=threads, limits=judging.cost)
    room = _native.rooms_of(before=found.error[0], floor=floor, cost=numbers_in(judging.cost))
    return ErrorScale(floor, np.asarray(room), found.rattle[0])


def lateness_s(table: ParameterTable) -> float:
    """Return the delay (s) of a board behind its leader: conversions, low-pass, half a period until a duty changes."""
    low_pass = ((1 << table["filter_shift"]) - 1) * TICK_S
    return CONVERSION_S + low_pass + 0.5e-3 * table.period_ms


def _least_errors(drill: TrainingMotion, plants: Floats, late_s: float, threads: int, judging: TuningLimits) -> Floats:
    """The ideal controller's error on every plant (plants, 4) in rad, measured like a candidate's."""
    led = drill.experiment.lines.motion(drill.motion)
    leader, angles = follow_ideally(led, plants, delay_s=late_s, wait_s=WAIT_S, threads=threads, limits=judging.floor)
    distance = np.abs(leader - angles)
    weight = drill.experiment.weight_s[:, None]
    mean, square = (weight * distance).sum(axis=1) / weight.sum(), np.square(distance).mean(axis=1)
    return np.asarray(_native.errors_of(weighted=mean, square=square, cost=numbers_in(judging.cost)))
