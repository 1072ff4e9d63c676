"""What a global search would add to the default identification's least squares: the same logs with it and without.

Ten random arms, and the paper's grey box with friction, whose motors are up to ten times those of the white box from
which both begin.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from unittest import mock

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.base.types import Floats
from greywhale.files.arm import load_arm
from greywhale.identify.candidate import Candidate
from greywhale.identify.fit import pick_different
from greywhale.identify.search import Search
from greywhale.identify.space import Space
from greywhale.identify.windows import WindowResidual
from greywhale.optimise import DEFAULT, create
from tools.benchmarks.bench_identify import ARMS, identified
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.support.recordings import random_arm, record_three

FAR = 0  # in the place of a random arm's number
# The search: evaluations, on so many windows, factors e^(+-2.5) around the white box; points that it gives.
EVALUATIONS, WINDOWS, SPREAD, STARTS = 500, 12, 2.5, 2
SAME = 0.1  # % points of improvement that nobody would notice


def with_and_without(seed: int) -> dict[str, list[float]]:
    """Improvement over the white box (%) on the second log and with the changed controller, and processor seconds."""
    arm = load_arm("sticky_grey_box") if seed == FAR else random_arm(seed)
    with tempfile.TemporaryDirectory() as folder:
        return {"with": _with(arm, Path(folder), seed), "without": _measure(arm, Path(folder), seed)}


def _measure(arm: ArmParameters, folder: Path, seed: int) -> list[float]:
    recorded = record_three(arm, folder, seed)
    begin = time.process_time()
    outcome, _ = identified(recorded)
    spent = time.process_time() - begin
    return [*(100.0 * verdict.improvement for verdict in outcome.verdicts[1:3]), spent]


def _with(arm: ArmParameters, folder: Path, seed: int) -> list[float]:
    """Two more points from which least squares starts: the best different ones of a global search."""
    whole = Search._starts

    def starts(self: Search, space: Space, motors: Candidate) -> list[Floats]:
        return [*whole(self, space, motors), *_search_globally(self, space)]

    with mock.patch.object(Search, "_starts", starts):
        return _measure(arm, folder, seed)


def _search_globally(task: Search, space: Space) -> list[Floats]:
    count = WindowResidual(task.logs, task.arm, task.joints).windows
    residual = WindowResidual(task.logs, task.arm, task.joints, False, max(1, count // WINDOWS))
    middle = space.start()
    low, high = space.bounds()
    low, high = np.maximum(low, middle - SPREAD), np.minimum(high, middle + SPREAD)
    seen: list[tuple[float, Floats]] = []
    with create(DEFAULT, low, high, budget=EVALUATIONS, seed=task.seed, start=middle[None]) as pack:
        while not pack.done:
            points = pack.ask()
            # Bounded per number, so that one joint with a large error does not hide what the others gain.
            costs = np.mean(np.log1p(residual(space, points) ** 2), axis=1)
            pack.tell(costs)
            seen += [(float(cost), point.copy()) for cost, point in zip(costs, points, strict=True)]
    return pick_different(seen, STARTS)


def run() -> list[Figure]:
    found = repeat(
        "identify_stages", [Task(f"arm {seed}", with_and_without, seed) for seed in (*range(1, ARMS + 1), FAR)]
    )
    figures = []
    for name, one in found.items():
        for place, what in enumerate(("set 2", "changed controller")):
            gain = one["with"][place] - one["without"][place]
            figures.append(Figure(f"{name}: {what}, without the global stage", one["without"][place], "%"))
            figures.append(Figure(f"{name}: {what}, what it adds", gain, "% points"))
    for place, what in enumerate(("set 2", "changed controller")):
        gains = np.array([one["with"][place] - one["without"][place] for one in found.values()])
        figures.append(
            Figure(f"{what}: arms on which it adds more than {SAME:g} points", int((gains > SAME).sum()), "arms")
        )
        figures.append(
            Figure(f"{what}: arms on which it costs more than {SAME:g} points", int((gains < -SAME).sum()), "arms")
        )
    spent = [one["with"][2] - one["without"][2] for one in found.values()]
    return [*figures, Figure("processor time that it takes, median", float(np.median(spent)), "s")]
