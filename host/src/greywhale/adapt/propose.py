"""The work in the background: the model is brought up to date, and GWO-WOA searches sets and factors on it.

It trains on what this person did, and says how much better the arm should follow that, and how certain this is. The
model is fitted to the newest stretches alone: a load may have been taken up since the older ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from greywhale.adapt.foresee import foresee, judged_of
from greywhale.adapt.gain import Scale
from greywhale.adapt.limits import ADAPTATION_LIMITS, AdaptationLimits, ProposalLimits
from greywhale.adapt.live_model import LiveModel
from greywhale.adapt.stretch import ROWS, Stretch, chains_of, traces_of
from greywhale.base.types import Controllers, Floats
from greywhale.files.trajectory import Trajectory
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.firmware import JOINTS, TICK_S
from greywhale.protocol.table import ParameterTable
from greywhale.tune import tune
from greywhale.tune.model import Model


@dataclass(frozen=True)
class Task:
    """A task for the background. `recent` ran with the controllers of `table`. A `budget` of 0: only fit the model,
    to them all, whatever controllers they ran with.
    """

    model: Model
    live: LiveModel
    table: ParameterTable
    start: Controllers  # (4, 13), from before this session
    recent: tuple[Stretch, ...] = field(repr=False)
    budget: int
    seed: int

    @property
    def limits(self) -> AdaptationLimits:
        return self.live.limits


@dataclass(frozen=True)
class Proposal:
    """A set (4, 13) and its predicted error as a share of that of the set that runs, on what this person did.

    `spread` is how much that differs between plants that are as likely; `scale` is how measured errors of the set that
    runs relate to the model's.
    """

    live: LiveModel
    rows: Controllers
    predicted: float
    spread: float
    scale: Scale


def propose(task: Task) -> Proposal:
    """Refit the model, search, and compare what was found and the set from the start with the set that runs."""
    live = _fit(task)
    running = controllers_of(task.table)
    before = foresee(live, task.table, running, task.recent, live.plants)
    measured = np.array([one.error for one in judged_of(task.recent, task.limits.gain.lead_s)])
    count = _count_alike(measured, before[0], task.limits)
    before = before[:, -count:]
    scale = Scale.of(measured[-count:], before[0], task.limits.gain)
    found = tune(
        replace(task.model, table=task.table, plants=live.plants, doubts=(), travel=None),
        budget=task.budget,
        seed=task.seed,
        threads=1,
        start=running,
        judging=task.limits.tuning,
        motion=motion_of(task.recent, task.limits.proposals),
    ).after
    best = (1.0, 0.0, running)
    for rows in (found, task.start):
        errors = foresee(live, task.table, rows, task.recent, live.plants)[:, -count:]
        sums = ([scale.expected(one).sum() for one in each] for each in (errors, before))
        ratios = [float(now / was) for now, was in zip(*sums, strict=True)]
        if ratios[0] < best[0]:
            best = ratios[0], float(np.std(np.log(ratios))), rows
    return Proposal(live, best[2], best[0], best[1], scale)


def work_on(task: Task) -> Proposal | LiveModel:
    return propose(task) if task.budget else _fit(task)


def _fit(task: Task) -> LiveModel:
    return task.live.refit(task.recent[-task.limits.proposals.newest_s :], task.table, task.seed)


def _count_alike(measured: Floats, predicted: Floats, limits: AdaptationLimits) -> int:
    """Count the last stretches that show the arm as it is now, from their errors (n, 4)."""
    newest, step = limits.proposals.newest_s - limits.gain.lead_s, limits.proposals.block_s
    scale = Scale.of(measured[-newest:], predicted[-newest:], limits.gain)
    count = min(newest, len(measured))
    while count + step <= len(measured):
        block = slice(len(measured) - count - step, len(measured) - count)
        older = Scale.of(measured[block], scale.factor * predicted[block], limits.gain)
        if older.error > limits.proposals.same_arm_log:
            break
        count += step
    return count


def motion_of(stretches: Sequence[Stretch], limits: ProposalLimits = ADAPTATION_LIMITS.proposals) -> Trajectory:
    """Return the person's motion in the longest part without a gap, from rest, followed by the motion backwards and
    faster; readings' noise is averaged.
    """
    chain = max(chains_of(stretches), key=len)[-limits.newest_s :]
    leader, every = traces_of(chain).leader, limits.row_every_ticks
    angles: Floats = leader.reshape(len(chain) * ROWS // every, every, JOINTS).mean(axis=1)
    rows = np.arange(len(angles), dtype=np.float64)
    back = np.arange(rows[-1] - limits.faster, 0.0, -limits.faster)
    angles = np.vstack([angles, np.transpose([np.interp(back, rows, joint) for joint in angles.T])])
    return Trajectory(every * TICK_S * np.arange(len(angles), dtype=np.float64), angles)
