"""Measures the distance of an identified model from an arm that it never saw: the default arm and ten random ones,
starting from the white box.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.study import Task
from greywhale.files.arm import default_arm, load_arm
from greywhale.identify import IdentificationResult, identify
from greywhale.identify.closed_loop import Loop
from greywhale.loop import plant_row
from greywhale.protocol.table import ParameterTable
from tools.benchmarks.figure import Figure, at_least, at_most
from tools.benchmarks.study import repeat
from tools.support.recordings import Recorded, random_arm, record_three, table_of

ARMS = 10
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


def of_arm(arm: ArmParameters, seed: int) -> tuple[IdentificationResult, float]:
    with tempfile.TemporaryDirectory() as folder:
        return identified(record_three(arm, Path(folder), seed))


def truth(outcome: IdentificationResult, arm: ArmParameters) -> float:
    """The true arm's own figures on the changed record: where joints hunt, no model repeats every swing."""
    subject, verdict = outcome.subjects[2], outcome.verdicts[2]
    assert subject.table is not None
    loop = Loop(subject.log, subject.table, outcome.white_box)
    return 1.0 - float(loop.error(plant_row(arm)[None]).sum()) / sum(verdict.white_box)


def of_random_arm(seed: int) -> dict[str, float]:
    """The gains of the model and of the true arm over the white box, and the time it took."""
    arm = random_arm(seed)
    outcome, seconds = of_arm(arm, seed)
    second, changed = (verdict.improvement for verdict in outcome.verdicts[1:3])
    return {"second": second, "changed": changed, "true arm": truth(outcome, arm), "seconds": seconds}


def run() -> list[Figure]:
    outcome, seconds = of_arm(default_arm(), 1)
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
    return figures
