"""Commissioning arms that the model does not know (MuJoCo's, with play at the potentiometers), on a bench in lock
step.

Judged on motions that a person leads and that the commissioning never sees. GREYWHALE_FOREIGN names other seeds.
"""

from __future__ import annotations

import os
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.base.study import Task
from greywhale.commission.judge import MOST_UNREST
from tools.benchmarks.figure import Figure, at_most
from tools.benchmarks.study import repeat
from tools.benchmarks.tuning import motions
from tools.support.foreign_arm import Run, commissioned

SEEDS = tuple(map(int, os.environ.get("GREYWHALE_FOREIGN", "1 2 3 4 5").split()))
WALL_S = 240.0
HUMAN_SHARE = 0.15


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
    return [*figures, at_most("foreign arms, human reaches: median", float(np.median(reaches)), "x", HUMAN_SHARE)]


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
            at_most(f"{head}, {name}: worst joint", worst, "x", 1.0),
            Figure(f"{head}, {name}: most that a joint's error grew", more, "mrad rms"),
        ]
    rests, rested = after.unrest["multi-steps"], before.unrest["multi-steps"]
    hunting = int(((rests > MOST_UNREST) | (rests > 2.0 * rested)).sum())
    return [
        *figures,
        Figure(f"{head}: most unrest at rest", 1e3 * float(rests.max()), "mrad rms"),
        Figure(f"{head}: joints that hunt at rest", hunting, "", "0", hunting == 0),
        at_most(f"{head}: wall time", wall_s, "s", WALL_S),
    ]
