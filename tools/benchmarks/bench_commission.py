"""Commissioning on a bench in lock step: the default arm, worn ones, and MuJoCo's with play at the potentiometers,
which the model does not know, some with traits besides. With those it is compared with `tune` alone.

Judged on motions that a person leads and that the commissioning never sees. GREYWHALE_ARMS names other arms:
"mujoco 7,worn 19,two-masses 4,two-masses+flexible 2".
"""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.base.errors import UserError
from greywhale.base.study import Task
from greywhale.files.model import arm_toml
from greywhale.measure.limits import SWING_LIMITS
from greywhale_sim.assemble import BenchOptions
from greywhale_sim.lockstep import LockStepBench
from tools.benchmarks.figure import Figure, at_most
from tools.benchmarks.study import repeat
from tools.benchmarks.tuning import motions
from tools.support.foreign_arm import TRAITS, Run, bench_of, commissioned, foreign_arm_with, tuned
from tools.support.recordings import worn_arm

KINDS = {
    "default": range(1, 4),
    "worn": range(11, 19),
    "mujoco": (1, 2, 3, 4, 6),
    "two-masses": (2, 5, 6),
    "flexible": (2, 6),
    "two-masses+flexible": (2,),
    "cogging": (3,),
    "dead-time": (5,),
}
ALL = ",".join(f"{kind} {seed}" for kind, seeds in KINDS.items() for seed in seeds)
ARMS = os.environ.get("GREYWHALE_ARMS", ALL).split(",")
WALL_S = 120.0
HUMAN_SHARE = 0.06
QUIET_V = 0.45
OF_TUNE = 1.1


def traits_of(kind: str) -> list[str]:
    """Of MuJoCo's arms: "two-masses+flexible" names two of them."""
    return [] if kind == "mujoco" else kind.split("+")


def bench_with(kind: str, seed: int, folder: Path) -> LockStepBench:
    """The bench with that arm."""
    if kind == "default":
        return LockStepBench(BenchOptions(seed=seed))
    if kind != "worn":
        return bench_of(foreign_arm_with(seed, traits_of(kind)), folder)
    path = folder / "worn.toml"
    path.write_text(arm_toml(worn_arm(seed), "A worn arm."), encoding="utf-8")
    return LockStepBench(BenchOptions(arm=path, seed=seed))


def followed(kind: str, seed: int) -> dict[str, Any]:
    """The arm's following before, after and, where it has traits, with `tune` alone if that ends with a controller: a
    Run's fields each, the wall time, and the sets tried on it.
    """
    with tempfile.TemporaryDirectory() as name, bench_with(kind, seed, Path(name)) as bench:
        done = commissioned(bench, Path(name), motions())
    found = {"before": asdict(done.before), "after": asdict(done.after), "wall_s": done.wall_s}
    if set(traits_of(kind)) & set(TRAITS):
        with tempfile.TemporaryDirectory() as name, bench_with(kind, seed, Path(name)) as bench:
            with suppress(UserError):  # the board stopped the arm in every motion, or its model is refused
                found["tune"] = asdict(tuned(bench, Path(name), motions())[1])
    return found | {"tried": len(done.outcome.trials.done) - 1}


def task_of(arm: str) -> Task:
    """For example "worn 12"."""
    kind, seed = arm.split()
    if kind not in KINDS and not set(traits_of(kind)) <= set(TRAITS):
        raise ValueError(f"no arm is of the kind {kind!r}; there are {', '.join([*KINDS, *TRAITS])}")
    return Task(arm, followed, int(seed), {"kind": kind})


def run() -> list[Figure]:
    found = repeat("commission", [task_of(arm) for arm in ARMS])
    figures: list[Figure] = []
    reaches = []
    for head, facts in found.items():
        before, after = Run(**facts["before"]), Run(**facts["after"])
        figures += judged(head, before, after, facts["wall_s"])
        figures.append(Figure(f"{head}: sets tried on the arm", facts["tried"], ""))
        reaches.append(float(after.error["human reaches"].sum() / before.error["human reaches"].sum()))
        if "tune" in facts:
            alone = float(facts["tune"]["error"]["human reaches"].sum())
            of_tune = float(after.error["human reaches"].sum()) / alone
            figures.append(at_most(f"{head}, human reaches: MSE commission / tune alone", of_tune, "x", OF_TUNE))
    return [*figures, at_most("all arms, human reaches: median", float(np.median(reaches)), "x", HUMAN_SHARE)]


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
    hunting = int(((rests > SWING_LIMITS.max_unrest_rad) | (rests > 2.0 * rested)).sum())
    quiet = np.fmax(QUIET_V, before.ripple["multi-steps"])
    louder = float((after.ripple["multi-steps"] / quiet).max())
    return [
        *figures,
        at_most(f"{head}: ripple at rest, worst joint, of what is allowed", louder, "x", 1.0),
        Figure(f"{head}: most unrest at rest before", 1e3 * float(rested.max()), "mrad rms"),
        Figure(f"{head}: most unrest at rest", 1e3 * float(rests.max()), "mrad rms"),
        Figure(f"{head}: joints that hunt at rest", hunting, "", "0", hunting == 0),
        at_most(f"{head}: wall time", wall_s, "s", WALL_S),
    ]
