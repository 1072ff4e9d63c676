"""How near an identified model comes to an arm that it never saw: the default arm and ten random ones, starting from
the white box; and methods side by side at 500 simulations of the closed loop.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters, default_arm, load_arm
from greywhale.identify import Outcome, Table, identify
from greywhale.identify.closed_loop import Loop, LoopResidual
from greywhale.identify.data import prepare
from greywhale.identify.fit import least_squares_fit
from greywhale.identify.paper import PaperSearch
from greywhale.identify.space import MOTOR, Space
from greywhale.optimise import minimise
from greywhale.simulate import plant_row
from tools.bench.figure import Figure
from tools.bench.recordings import Recorded, random_arm, record_three, table_of

ARMS = 10
BUDGET = 500
NAMES = ("before_tuning", "table_10")


def tables() -> list[Table]:
    return [Table(name, table_of(name)) for name in NAMES]


def identified(recorded: Recorded) -> tuple[Outcome, float]:
    begin = time.perf_counter()
    outcome = identify(
        [recorded.fit], load_arm("white_box"), validate=[recorded.second, recorded.changed], tables=tables()
    )
    return outcome, time.perf_counter() - begin


def side_by_side(recorded: Recorded) -> list[Figure]:
    """Improvement on the second log at 500 simulations of the closed loop with the first."""
    white = load_arm("white_box")
    values = table_of(NAMES[0])
    first, second = (Loop(prepare(log, 1), values, white) for log in (recorded.fit, recorded.second))
    start = Space.of(white, (), ())
    before = second.error(start.base[None])[0].sum()

    def better(plants: np.ndarray) -> float:
        return float(1.0 - second.error(plants)[0].sum() / before)

    paper = PaperSearch(white, [first], 0, lambda what, share: None)
    paper.run()
    assert paper.x is not None
    found = {"paper, 20 values": better(paper.plants(paper.x[None]))}
    space = Space.of(white, (*MOTOR, "coulomb"), range(4))
    low, high = np.maximum(space.bounds()[0], space.start() - 2.5), np.minimum(space.bounds()[1], space.start() + 2.5)
    for method in ("gwo-woa", "gwo-woa-relative", "de", "cma-es"):
        minimum = minimise(
            lambda points: first.error(space.plants(points)).sum(axis=1),
            low,
            high,
            method=method,
            budget=BUDGET,
            start=space.start()[None],
        )
        found[f"{method}, motors and Coulomb"] = better(space.plants(minimum.x[None]))
    steps = BUDGET // (len(space) + 1)
    alone = least_squares_fit(LoopResidual([first], range(4)), space, space.start(), steps, 5.0)
    found["least squares alone"] = better(space.plants(alone.x[None]))
    return [
        Figure(f"default arm, {BUDGET} simulations: {name}", 100 * value, "% better") for name, value in found.items()
    ]


def of_arm(arm: ArmParameters, seed: int) -> tuple[Outcome, float]:
    with tempfile.TemporaryDirectory() as folder:
        return identified(record_three(arm, Path(folder), seed))


def truth(outcome: Outcome, arm: ArmParameters) -> float:
    """What the true arm itself reaches on the changed record: where joints hunt, no model repeats every swing."""
    subject, verdict = outcome.subjects[2], outcome.verdicts[2]
    assert subject.table is not None
    loop = Loop(subject.log, subject.table.values, outcome.white_box)
    return 1.0 - float(loop.error(plant_row(arm)[None]).sum()) / sum(verdict.white_box)


def run() -> list[Figure]:
    outcome, seconds = of_arm(default_arm(), 1)
    gains = [100 * verdict.improvement for verdict in outcome.verdicts]
    figures = [
        Figure("default arm: better than white box, set 2", gains[1], "%", ">= 97", gains[1] >= 97),
        Figure("default arm: the same, changed controller", gains[2], "%", ">= 90", gains[2] >= 90),
        Figure("identification of a 30 s log", seconds, "s", "<= 30", seconds <= 30),
    ]
    second, changed, times, ceiling = [], [], [], []
    for seed in range(1, ARMS + 1):
        arm = random_arm(seed)
        outcome, seconds = of_arm(arm, seed)
        ceiling.append(100 * truth(outcome, arm))
        second.append(100 * outcome.verdicts[1].improvement)
        changed.append(100 * outcome.verdicts[2].improvement)
        times.append(seconds)
    middle, least, other = float(np.median(second)), min(second), float(np.median(changed))
    figures += [
        Figure(f"{ARMS} random arms: set 2, median", middle, "%", ">= 97", middle >= 97),
        Figure(f"{ARMS} random arms: set 2, least", least, "%", ">= 90", least >= 90),
        Figure(f"{ARMS} random arms: changed controller, median", other, "%", ">= 90", other >= 90),
        Figure(f"{ARMS} random arms: the same of the true arms", float(np.median(ceiling)), "%"),
        Figure(f"{ARMS} random arms: slowest", max(times), "s", "<= 30", max(times) <= 30),
    ]
    with tempfile.TemporaryDirectory() as folder:
        figures += side_by_side(record_three(default_arm(), Path(folder), 1))
    return figures
