"""Commissions a foreign arm on a bench in lock step, and records unseen motions before and after."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from greywhale.base.types import Floats
from greywhale.cli.story import RunningBench, record_motion
from greywhale.commission import CommissioningRequest, commission
from greywhale.commission.result import CommissioningResult
from greywhale.files.leader import save_leader
from greywhale.files.trajectory import Trajectory
from greywhale.motion import evaluate
from greywhale.motion.swings import unrest
from greywhale.protocol.firmware import TICK_S
from tools.support.foreign_arm import bench_of


@dataclass(frozen=True)
class Run:
    """Errors (4,) rad² and unrest (4,) rad rms by motion."""

    error: dict[str, Floats]
    unrest: dict[str, Floats]


@dataclass(frozen=True)
class Commissioned:
    """How an arm followed unseen motions before and after, what was tried in between, and its wall time (s)."""

    before: Run
    after: Run
    outcome: CommissioningResult
    wall_s: float

    @property
    def kept(self) -> npt.NDArray[np.bool_]:
        """(4,): joints that keep their controllers from before."""
        same: npt.NDArray[np.bool_] = (self.outcome.best.rows == self.outcome.trials.before.rows).all(axis=1)
        return same


def commissioned(seed: int, folder: Path, unseen: Mapping[str, Trajectory], **options: Any) -> Commissioned:
    """Commission the arm of that seed on a bench in lock step."""
    with bench_of(seed, folder) as bench:
        before = recorded(bench, folder, "before", unseen)
        started = time.monotonic()
        outcome = commission(CommissioningRequest(port=bench.port, out=folder / "commission", **options))
        wall = time.monotonic() - started
        return Commissioned(before, recorded(bench, folder, "after", unseen), outcome, wall)


def recorded(bench: RunningBench, folder: Path, when: str, unseen: Mapping[str, Trajectory]) -> Run:
    """Every motion with the controllers that the board has."""
    errors, rests = {}, {}
    for name, motion in unseen.items():
        leader = folder / "leader.csv"
        save_leader(leader, motion)
        log = record_motion(bench, leader, folder / f"{when} {name}.csv").log()
        errors[name] = np.array([joint.mse for joint in evaluate(log).joints])
        grid = np.arange(0.0, float(log.time[-1]), TICK_S)
        even = [
            np.column_stack([np.interp(grid, log.time, values[:, joint]) for joint in range(4)])
            for values in (log.leader, log.follower)
        ]
        rests[name] = unrest(even[0], even[1], still_rad=0.02)
    return Run(errors, rests)
