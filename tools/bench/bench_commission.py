"""Commissioning arms that the model does not know (MuJoCo's, with play at the potentiometers), on a bench in lock
step.

Judged on motions that a person leads and that the commissioning never sees. GREYWHALE_FOREIGN names other seeds.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from greywhale.commission import Options, commission
from greywhale.commission.judge import MOST_UNREST
from greywhale.commission.measures import unrest
from greywhale.commission.outcome import Outcome
from greywhale.demo import RunningBench, record_motion
from greywhale.files.leader import save_leader
from greywhale.firmware import TICK_S
from greywhale.measure import evaluate
from greywhale.study import Task
from greywhale.trajectory import Trajectory
from tools.bench.figure import Figure
from tools.bench.foreign_arm import bench_of
from tools.bench.study import repeat
from tools.bench.tuning import motions

Floats = npt.NDArray[np.float64]

ROOT = Path(__file__).parents[2]

SEEDS = tuple(map(int, os.environ.get("GREYWHALE_FOREIGN", "1 2 3 4 5").split()))
WALL_S = 240.0
HUMAN_SHARE = 0.15


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
    outcome: Outcome
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
        outcome = commission(Options(port=bench.port, out=folder / "commission", **options))
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


def followed(seed: int) -> dict[str, Any]:
    """How the arm of that seed follows before and after: a Run's fields each, and the wall time."""
    with tempfile.TemporaryDirectory() as folder:
        done = commissioned(seed, Path(folder), motions())
    return {"before": asdict(done.before), "after": asdict(done.after), "wall_s": done.wall_s}


def run() -> list[Figure]:
    found = repeat("commission", [Task(f"foreign arm {seed}", followed, seed) for seed in SEEDS])
    figures: list[Figure] = []
    reaches = []
    for head, facts in found.items():
        before, after = Run(**facts["before"]), Run(**facts["after"])
        figures += judged(head, before, after, facts["wall_s"])
        reaches.append(float(after.error["human reaches"].sum() / before.error["human reaches"].sum()))
    median = float(np.median(reaches))
    holds = median <= HUMAN_SHARE
    figures.append(Figure("foreign arms, human reaches: median", median, "x", f"<= {HUMAN_SHARE}", holds))
    return figures


def judged(head: str, before: Run, after: Run, wall_s: float) -> list[Figure]:
    """The figures of one arm."""
    figures = []
    for name, was in before.error.items():
        ratios = after.error[name] / was
        total = float(after.error[name].sum() / was.sum())
        worst = float(ratios.max())
        # A joint that holds still has next to no error: a ratio alone says little there.
        more = 1e3 * float((np.sqrt(after.error[name]) - np.sqrt(was)).max())
        figures += [
            Figure(f"{head}, {name}: MSE after / before", total, "x"),
            Figure(f"{head}, {name}: worst joint", worst, "x", "<= 1", worst <= 1.0),
            Figure(f"{head}, {name}: most that a joint's error grew", more, "mrad rms"),
        ]
    rests, rested = after.unrest["multi-steps"], before.unrest["multi-steps"]
    hunting = int(((rests > MOST_UNREST) | (rests > 2.0 * rested)).sum())
    return [
        *figures,
        Figure(f"{head}: most unrest at rest", 1e3 * float(rests.max()), "mrad rms"),
        Figure(f"{head}: joints that hunt at rest", hunting, "", "0", hunting == 0),
        Figure(f"{head}: wall time", wall_s, "s", f"<= {WALL_S:g}", wall_s <= WALL_S),
    ]
