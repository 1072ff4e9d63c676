"""The paper's own tuning on its grey-box arm, all three strategies, beside its Tables 8 to 12.

The paper's printed controllers run in the same simulation as those that its method finds here (20 ms, 15 V or 20 V), so
that only the search differs. The tables go to build/bench_tune_paper.txt.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from greywhale.arm.plants import column
from greywhale.base.study import Task
from greywhale.base.types import Controllers, Floats
from greywhale.files import controller
from greywhale.files.paper_tables import paper_table
from greywhale.motion import multi_steps, steps
from greywhale.protocol.table import ParameterTable
from greywhale.simulate import Experiment, controller_row
from greywhale.tune import tune
from greywhale.tune.model import load_model
from greywhale.tune.report.tables import tables_of
from tools import ROOT
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat

# Strategy, what it is called here, where the paper prints its result.
STRATEGIES = (("sf", "scaling factors", "table_8"), ("both", "both", "table_9"), ("mf", "sets", "table_10"))
SEEDS = range(10)
PAPER_LOWER = 78.0  # %, Table 11
TABLES = ROOT / "build" / "bench_tune_paper.txt"


def tuned(seed: int, strategy: str) -> dict[str, Any]:
    """One run of the search: its controllers as found; of seed 0 also those before, parameters and tables."""
    outcome = tune(load_model("grey_box", force=True), method="paper", strategy=strategy, seed=seed, floors=seed == 0)
    facts: dict[str, Any] = {"after": outcome.after}
    if seed == 0:
        tables = "\n\n".join(one.text() for one in tables_of(outcome, paper=True))
        facts |= {"before": outcome.before, "table": list(outcome.table.raw), "tables": tables}
    return facts


def errors(table: ParameterTable, rows: Controllers) -> tuple[Floats, Floats]:
    """Total MSE of controllers (n, 4, 13) on the steps and the multi-steps, (n,) each."""
    model = load_model("grey_box", force=True)
    plant = model.plants[0].copy()
    plant[column("supply")] = table.supply_v
    found = []
    for motion in (steps(), multi_steps()):
        experiment = Experiment(motion, model.arm, table=table, noise=False)
        found.append(experiment.run_exact(rows, plant).mse.sum(axis=1))
    return found[0], found[1]


def run() -> list[Figure]:
    tasks = [
        Task(f"{strategy}, seed {seed}", tuned, seed, {"strategy": strategy})
        for strategy, *_ in STRATEGIES
        for seed in SEEDS
    ]
    results = repeat("tune_paper", tasks)
    figures, texts = [], []
    for strategy, name, printed in STRATEGIES:
        outcomes = [results[f"{strategy}, seed {seed}"] for seed in SEEDS]
        first = outcomes[0]
        theirs = controller_row(controller.load(paper_table(printed)))
        rows = np.stack([first["before"], theirs, *(one["after"] for one in outcomes)])
        for motion, found in zip(
            ("steps", "multi-steps"), errors(ParameterTable(tuple(first["table"])), rows), strict=True
        ):
            head = f"paper's method, {name}, {motion}"
            ours = float(np.median(found[2:]))
            lower = 100.0 * (1.0 - ours / found[0])
            figures += [
                Figure(f"{head}: MSE before", float(found[0]), "rad2"),
                Figure(f"{head}: of the paper's {printed.replace('_', ' ')}", float(found[1]), "rad2"),
                Figure(f"{head}: found here, median of {len(SEEDS)}", ours, "rad2"),
                Figure(f"{head}: lowest", float(found[2:].min()), "rad2"),
                Figure(f"{head}: highest", float(found[2:].max()), "rad2"),
                Figure(f"{head}: lower by (median)", lower, "%", f"paper: {PAPER_LOWER:g} on its arm"),
            ]
        texts.append(f"Strategy {strategy} ({name}), seed 0\n\n" + first["tables"])
    TABLES.write_text("\n\n\n".join(texts) + "\n", encoding="utf-8")
    return figures
