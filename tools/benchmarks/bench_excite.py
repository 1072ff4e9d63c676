"""What a designed motion tells about an arm, beside plain human reaches of equal length: the information and what the
identification makes of the log, on the default arm and on random ones that it must not know.
"""

from __future__ import annotations

import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.base.types import Floats
from greywhale.files.arm import default_arm, load_arm
from greywhale.files.trajectory import Trajectory
from greywhale.identify import IdentificationResult, identify
from greywhale.identify.excite import Design, design
from greywhale.identify.space import MOTOR, Space
from greywhale.motion import human_reaches
from tools.benchmarks.bench_identify import tables
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.support.recordings import random_arm, record, table_of

ARMS = 6
SECONDS = 20.0
# The middle of where a hand likes to be; a person puts the arm there before recording.
POSE = (0.0, 0.45, -0.1, 0.0)
CHECKED = (*MOTOR, "coulomb")


@dataclass(frozen=True)
class Compared:
    """Of one arm and one motion: errors of the logarithms of motor and friction values; by which share the model is
    better than the white box on the second log and with the changed controller.
    """

    errors: Floats
    second: float
    changed: float


def rows_of(motion: Trajectory) -> Floats:
    """The motion as points 16 ms apart, as a board would be told it."""
    return motion.at(np.arange(0.0, SECONDS, 0.016))


def errors_of(outcome: IdentificationResult, arm: ArmParameters) -> Floats:
    """Identified minus true logarithms (4 joints x alpha, inertia, damping, Coulomb)."""
    truth = dict(zip((space := Space.of(arm, CHECKED, range(4))).names, space.values(space.start()), strict=True))
    found = {one.name: one.value for one in outcome.estimates}
    return np.array([np.log(found[name] / true) for name, true in truth.items() if name in found])


def compare(arm: ArmParameters, motion: Trajectory, seed: int) -> Compared:
    """Record `motion` on the arm, identify it from the white box, validate on human reaches."""
    before, after = table_of("before_tuning"), table_of("table_10")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        fit = record(arm, motion, folder / "fit.csv", before, 10 * seed + 1)
        second = record(arm, human_reaches(10 * seed + 2, SECONDS), folder / "second.csv", before, 10 * seed + 2)
        changed = record(arm, human_reaches(10 * seed + 3, SECONDS), folder / "changed.csv", after, 10 * seed + 3)
        outcome = identify([fit], load_arm("white_box"), validate=[second, changed], tables=tables())
    gains = [verdict.improvement for verdict in outcome.verdicts]
    return Compared(errors_of(outcome, arm), gains[1], gains[2])


def both_ways(seed: int, time_s: Floats, angles: Floats) -> list[dict[str, Any]]:
    """The arm of that seed (0: the default arm) with both motions, designed first: each a Compared's fields."""
    arm, number = (random_arm(seed), seed) if seed else (default_arm(), 1)
    motions = (Trajectory(time_s, angles), human_reaches(10 * number + 1, SECONDS))
    return [asdict(compare(arm, motion, number)) for motion in motions]


def half_log_det(made: Design, motion: Trajectory) -> float:
    return 0.5 * made.problem.judge(rows_of(motion)).log_det


def run() -> list[Figure]:
    made = design(load_arm("white_box"), POSE, table=table_of("before_tuning"), seconds=SECONDS)
    count = len(made.problem.parameters)
    hands = [half_log_det(made, human_reaches(seed, SECONDS)) for seed in range(1, 6)]
    gain = 0.5 * made.judgement.log_det - float(np.median(hands))
    figures = [
        Figure("information, designed motion (half of log det)", 0.5 * made.judgement.log_det, "nats"),
        Figure("information, human reaches, median of 5", float(np.median(hands)), "nats"),
        Figure("deviations smaller by (geometric mean)", float(np.exp(gain / count)), "times", "> 1", gain > 0),
        Figure(
            "largest lag on 16 arms",
            float(made.judgement.tried.lag.max()),
            "rad",
            "<= 0.36",
            made.judgement.excess == 0,
        ),
    ]
    told = {"time_s": made.motion.time_s, "angles": made.motion.angles}
    tasks = [Task(f"random arm {seed}" if seed else "default arm", both_ways, seed, told) for seed in range(ARMS + 1)]
    designed, human = [], []
    for name, facts in repeat("excite", tasks).items():
        pair = [Compared(**one) for one in facts]
        designed.append(pair[0])
        human.append(pair[1])
        figures += [
            Figure(f"{name}: {what}, {motion}", 100 * value, "%")
            for motion, one in zip(("designed", "human"), pair, strict=True)
            for what, value in (
                ("motors and friction wrong by, median", float(np.median(np.abs(one.errors)))),
                ("second log better by", one.second),
                ("changed controller better by", one.changed),
            )
        ]
    ours = float(np.median(np.abs(np.concatenate([one.errors for one in designed]))))
    theirs = float(np.median(np.abs(np.concatenate([one.errors for one in human]))))
    figures.append(Figure("all arms: values wrong by, median, designed", 100 * ours, "%", "< human", ours < theirs))
    figures.append(Figure("all arms: values wrong by, median, human", 100 * theirs, "%"))
    return figures
