"""The paper's own tuning on its grey-box arm, all three strategies, beside its Tables 8 to 12.

The paper's printed controllers run in the same simulation as those that its method finds here (20 ms, 15 V or 20 V), so
that only the search differs. The tables go to build/bench_tune_paper.txt.
"""

from __future__ import annotations

import numpy as np

from greywhale.arm.plants import column
from greywhale.files import controller
from greywhale.files.paper_tables import paper_table
from greywhale.loop import Experiment, controller_row
from greywhale.loop.controllers import Controllers
from greywhale.trajectory import multi_steps, steps
from greywhale.trajectory.motion import Array
from greywhale.tune import Outcome, tune
from greywhale.tune.model import load_model
from greywhale.tune.report.tables import tables_of
from tools.bench.figure import Figure
from tools.setup.console import ROOT

# Strategy, what it is called here, where the paper prints its result.
STRATEGIES = (("sf", "scaling factors", "table_8"), ("both", "both", "table_9"), ("mf", "sets", "table_10"))
SEEDS = range(10)
PAPER_LOWER = 78.0  # %, Table 11
TABLES = ROOT / "build" / "bench_tune_paper.txt"


def errors(outcome: Outcome, rows: Controllers) -> tuple[Array, Array]:
    """Total MSE of controllers (n, 4, 12) on the steps and the multi-steps, (n,) each."""
    plant = outcome.model.plants[0].copy()
    plant[column("supply")] = outcome.supply_v
    found = []
    for motion in (steps(), multi_steps()):
        experiment = Experiment(motion, outcome.model.arm, table=outcome.table, noise=False)
        found.append(experiment.run_single(rows, plant).mse.sum(axis=1))
    return found[0], found[1]


def run() -> list[Figure]:
    model = load_model("grey_box", force=True)
    figures, texts = [], []
    for strategy, name, printed in STRATEGIES:
        outcomes = [tune(model, method="paper", strategy=strategy, seed=seed, floors=seed == 0) for seed in SEEDS]
        first = outcomes[0]
        theirs = controller_row(controller.load(paper_table(printed)))
        rows = np.stack([first.before, theirs, *(one.after for one in outcomes)])
        for motion, found in zip(("steps", "multi-steps"), errors(first, rows), strict=True):
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
        texts.append(
            f"Strategy {strategy} ({name}), seed 0\n\n"
            + "\n\n".join(one.text() for one in tables_of(first, paper=True))
        )
    TABLES.write_text("\n\n\n".join(texts) + "\n", encoding="utf-8")
    return figures
