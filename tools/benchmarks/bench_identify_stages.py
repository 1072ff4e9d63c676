"""What the global stage of the default identification adds to least squares: the same logs with it and without.

Ten random arms, and the paper's grey box with friction, whose motors are up to ten times those of the white box from
which both begin.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.base.types import Floats
from greywhale.files.arm import load_arm
from greywhale.identify import search
from greywhale.identify.space import Space
from tools.benchmarks.bench_identify import ARMS, identified
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat
from tools.support.recordings import random_arm, record_three

FAR = 0  # in the place of a random arm's number
SAME = 0.1  # % points of improvement that nobody would notice


def with_and_without(seed: int) -> dict[str, list[float]]:
    """Improvement over the white box (%) on the second log and with the changed controller, and processor seconds."""
    arm = load_arm("sticky_grey_box") if seed == FAR else random_arm(seed)
    with tempfile.TemporaryDirectory() as folder:
        return {"with": _measure(arm, Path(folder), seed), "without": _without(arm, Path(folder), seed)}


def _measure(arm: ArmParameters, folder: Path, seed: int) -> list[float]:
    recorded = record_three(arm, folder, seed)
    begin = time.process_time()
    outcome, _ = identified(recorded)
    spent = time.process_time() - begin
    return [*(100.0 * verdict.improvement for verdict in outcome.verdicts[1:3]), spent]


def _without(arm: ArmParameters, folder: Path, seed: int) -> list[float]:
    whole = search.Search._search_globally
    try:
        search.Search._search_globally = _find_nothing  # type: ignore[method-assign]
        return _measure(arm, folder, seed)
    finally:
        search.Search._search_globally = whole  # type: ignore[method-assign]


def _find_nothing(self: search.Search, space: Space) -> list[Floats]:
    return []


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
