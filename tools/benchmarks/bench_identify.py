"""How near an identified model comes to an arm that it never saw: the default arm and ten random ones, starting from
the white box; and methods side by side, all simulating for as many seconds of arm as the default method does.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.base.types import show_no_progress
from greywhale.files.arm import default_arm, load_arm
from greywhale.identify import IdentificationResult, identify
from greywhale.identify.closed_loop import Loop, LoopResidual
from greywhale.identify.data import prepare
from greywhale.identify.fit import least_squares_fit
from greywhale.identify.paper import PaperSearch
from greywhale.identify.space import MOTOR, Space
from greywhale.optimise import minimise
from greywhale.protocol.table import ParameterTable
from greywhale.simulate import plant_row
from tools.benchmarks.figure import Figure, at_least, at_most
from tools.benchmarks.study import repeat
from tools.support.recordings import Recorded, random_arm, record_three, table_of

ARMS = 10
PAPER_BUDGET = 510
NAMES = ("before_tuning", "table_10")


def tables() -> list[ParameterTable]:
    return [table_of(name) for name in NAMES]


def identified(recorded: Recorded) -> tuple[IdentificationResult, float]:
    begin = time.perf_counter()
    outcome = identify(
        [recorded.fit], load_arm("white_box"), validate=[recorded.second, recorded.changed], tables=tables()
    )
    if not outcome.complete:
        raise KeyboardInterrupt
    return outcome, time.perf_counter() - begin


def side_by_side(recorded: Recorded, outcome: IdentificationResult) -> list[Figure]:
    """Improvement on the second log and with the changed controller: at the paper's 510 closed loops, and at as many
    closed loops as take the seconds of arm that the default method simulates (mostly in windows of half a second).
    """
    white = load_arm("white_box")
    values = [table_of(name) for name in NAMES]
    logs = [prepare(log, 1) for log in (recorded.fit, recorded.second, recorded.changed)]
    first, second, changed = (Loop(log, values[n], white) for log, n in zip(logs, (0, 0, 1), strict=True))
    before = [float(loop.error(Space.of(white, (), ()).base[None]).sum()) for loop in (second, changed)]
    budget = round(outcome.found.simulated / first.seconds)

    def better(plants: np.ndarray) -> list[float]:
        return [
            1.0 - float(loop.error(plants).sum()) / one for loop, one in zip((second, changed), before, strict=True)
        ]

    paper = PaperSearch(white, [first], 0, show_no_progress)
    paper.run()
    assert paper.x is not None
    found = {f"paper, 20 values, {PAPER_BUDGET}": better(paper.plants(paper.x[None]))}
    space = Space.of(white, (*MOTOR, "coulomb"), range(4))
    low, high = np.maximum(space.bounds()[0], space.start() - 2.5), np.minimum(space.bounds()[1], space.start() + 2.5)
    for method, allowed in (
        (m, n) for n in (PAPER_BUDGET, budget) for m in ("gwo-woa", "gwo-woa-relative", "de", "cma-es")
    ):
        minimum = minimise(
            lambda points: first.error(space.plants(points)).sum(axis=1),
            low,
            high,
            method=method,
            budget=allowed,
            start=space.start()[None],
        )
        found[f"{method}, motors and Coulomb, {allowed}"] = better(space.plants(minimum.x[None]))
    for allowed in (PAPER_BUDGET, budget):
        steps = allowed // (len(space) + 1)
        alone = least_squares_fit(LoopResidual([first], range(4)), space, space.start(), steps, 5.0)
        found[f"least squares alone, {allowed}"] = better(space.plants(alone.x[None]))
    found[f"default, as long as {budget}"] = [verdict.improvement for verdict in outcome.verdicts[1:]]
    return [
        Figure(f"default arm, closed loops: {name}; {which}", 100 * value, "% better")
        for name, pair in found.items()
        for which, value in zip(("set 2", "changed controller"), pair, strict=True)
    ]


def of_arm(arm: ArmParameters, seed: int) -> tuple[IdentificationResult, float]:
    with tempfile.TemporaryDirectory() as folder:
        return identified(record_three(arm, Path(folder), seed))


def truth(outcome: IdentificationResult, arm: ArmParameters) -> float:
    """What the true arm itself reaches on the changed record: where joints hunt, no model repeats every swing."""
    subject, verdict = outcome.subjects[2], outcome.verdicts[2]
    assert subject.table is not None
    loop = Loop(subject.log, subject.table, outcome.white_box)
    return 1.0 - float(loop.error(plant_row(arm)[None]).sum()) / sum(verdict.white_box)


def of_random_arm(seed: int) -> dict[str, float]:
    """How much better the model is than the white box, and the true arm itself; how long it took."""
    arm = random_arm(seed)
    outcome, seconds = of_arm(arm, seed)
    second, changed = (verdict.improvement for verdict in outcome.verdicts[1:3])
    return {"second": second, "changed": changed, "true arm": truth(outcome, arm), "seconds": seconds}


def run() -> list[Figure]:
    outcome, seconds = of_arm(default_arm(), 1)
    default = outcome
    gains = [100 * verdict.improvement for verdict in outcome.verdicts]
    figures = [
        at_least("default arm: better than white box, set 2", gains[1], "%", 97),
        at_least("default arm: the same, changed controller", gains[2], "%", 90),
        at_most("identification of a 30 s log", seconds, "s", 30),
    ]
    tasks = [Task(f"random arm {seed}", of_random_arm, seed) for seed in range(1, ARMS + 1)]
    found = repeat("identify", tasks).values()
    second, changed, ceiling = ([100 * one[key] for one in found] for key in ("second", "changed", "true arm"))
    times = [one["seconds"] for one in found]
    figures += [
        at_least(f"{ARMS} random arms: set 2, median", float(np.median(second)), "%", 97),
        at_least(f"{ARMS} random arms: set 2, least", min(second), "%", 90),
        at_least(f"{ARMS} random arms: changed controller, median", float(np.median(changed)), "%", 90),
        Figure(f"{ARMS} random arms: the same of the true arms", float(np.median(ceiling)), "%"),
        at_most(f"{ARMS} random arms: slowest", max(times), "s", 30),
    ]
    with tempfile.TemporaryDirectory() as folder:
        figures += side_by_side(record_three(default_arm(), Path(folder), 1), default)
    return figures
