"""Ten arms drawn at random: each practises, is identified, is tuned on that model, and is judged as it truly is.

The recordings and the verdicts come from the native closed loop, which repeats the firmware on the bench duty by duty
(tests/simulate); the true arm is known to nobody but this judge.
"""

from __future__ import annotations

import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.base.types import Controllers, Floats
from greywhale.cli.story.learn import learn
from greywhale.cli.story.practice import tables
from greywhale.files.arm import load_arm
from greywhale.motion import human_reaches, multi_steps, steps
from greywhale.motion.swings import LIMIT_CYCLE, turns_of
from greywhale.protocol.table import ParameterTable
from greywhale.simulate import Experiment, default_controller, plant_row
from greywhale.tune.judge.floor import saturation_floor
from greywhale.tune.judge.margins import Margin, Margins
from tools.benchmarks.figure import Figure, at_most
from tools.benchmarks.study import repeat
from tools.benchmarks.tuning import practised
from tools.support.recordings import random_arm

ARMS = range(1, 11)
MOTIONS = {"steps": steps(), "multi-steps": multi_steps(), "human reaches": human_reaches(1, 20.0)}
LOOK_S, HOLD_S = 1.0, 2.5  # a joint cycles in the last second of a hold


@dataclass(frozen=True)
class Verdict:
    """One true arm under the controllers tuned for its model: MSE (4,) before and after, floors, unrest."""

    seed: int
    before: dict[str, Floats]
    after: dict[str, Floats]
    floor: Floats  # on steps
    margins: tuple[Margin, ...]
    cycling: tuple[int, ...]  # joints that swing in the rests of the multi-steps

    @property
    def failing(self) -> list[Margin]:
        return [margin for margin in self.margins if not margin.holds]

    def ratio(self, motion: str) -> float:
        return float(self.after[motion].sum() / self.before[motion].sum())


def judged(seed: int) -> dict[str, Any]:
    """A whole arm's Verdict, as its fields."""
    arm = random_arm(seed)
    with tempfile.TemporaryDirectory() as folder:
        fit, *checks = practised(arm, Path(folder), seed)
        learnt = learn(fit, checks, tables(ParameterTable.defaults()), load_arm("white_box"), Path(folder))
    return asdict(on_the_true_arm(seed, arm, learnt.tuning.after))


def verdict_of(facts: dict[str, Any]) -> Verdict:
    margins = tuple(Margin(**one) for one in facts["margins"])
    return Verdict(**(facts | {"margins": margins, "cycling": tuple(facts["cycling"])}))


def on_the_true_arm(seed: int, arm: ArmParameters, tuned: Controllers) -> Verdict:
    before, after = {}, {}
    rows, plant = np.stack([default_controller(), tuned]), plant_row(arm)
    for name, motion in MOTIONS.items():
        result = Experiment(motion, arm, seed=seed).run_exact(rows, plant, every=1)
        before[name], after[name] = result.mse
        if name == "multi-steps":
            cycling = cycling_joints(np.asarray(result.angles[1], dtype=np.float64))
    return Verdict(
        seed=seed,
        before=before,
        after=after,
        floor=saturation_floor(MOTIONS["steps"], arm).mse,
        margins=Margins(arm, ParameterTable.defaults(), plant[None]).check(tuned),
        cycling=cycling,
    )


def cycling_joints(angles: Floats) -> tuple[int, ...]:
    """Joints in a limit cycle at the end of a hold of the multi-steps; `angles` at every tick of 1 ms."""
    hold, look = round(1e3 * HOLD_S), round(1e3 * LOOK_S)
    turns = [turns_of(angles[end - look : end], LIMIT_CYCLE.band_rad) for end in range(len(angles), hold, -hold)]
    return tuple(np.flatnonzero(np.max(turns, axis=0) >= LIMIT_CYCLE.turns).tolist())


def run() -> list[Figure]:
    found = repeat("tune_arms", [Task(f"random arm {seed}", judged, seed) for seed in ARMS])
    verdicts = [verdict_of(facts) for facts in found.values()]
    figures = []
    for one in verdicts:
        head = f"random arm {one.seed}"
        multiple = float(one.after["steps"].sum() / one.floor.sum())
        worst = float((one.after["multi-steps"] / one.before["multi-steps"]).max())
        figures += [
            *(Figure(f"{head}, {name}: MSE after / before", one.ratio(name), "x") for name in MOTIONS),
            Figure(f"{head}, steps: MSE over the floor", multiple, "x"),
            at_most(f"{head}, multi-steps: worst joint", worst, "x", 1.0),
            Figure(f"{head}: joints cycling after multi-steps", len(one.cycling), "", "0", not one.cycling),
        ]
        for margin in one.failing:
            figures.append(
                Figure(
                    f"{head}, joint {margin.joint}, {margin.scenario}: reversals", margin.reversals, "", "rest", False
                )
            )
    resting = sum(any(margin.scenario == "at rest" for margin in one.failing) for one in verdicts)
    short = sum(bool(one.failing) for one in verdicts)
    cycling = sum(bool(one.cycling) for one in verdicts)
    figures += [
        Figure(
            "random arms with a joint that cycles at rest", max(resting, cycling), "of 10", "0", resting + cycling == 0
        ),
        Figure("random arms with a margin missing", short, "of 10", "0", short == 0),
    ]
    for name in MOTIONS:
        ratios = [one.ratio(name) for one in verdicts]
        figures.append(Figure(f"random arms, {name}: MSE after / before, median", float(np.median(ratios)), "x"))
        figures.append(at_most(f"random arms, {name}: MSE after / before, worst", max(ratios), "x", 1.0))
    return figures
