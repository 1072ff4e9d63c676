"""Which optimiser tunes best: every method at equal budgets on the default objective, many seeds, one identified arm.

What is compared is the cost that the search itself found (mrad, summed over the joints). The table goes to
build/bench_tune_methods.md as well.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np
from scipy.stats import mannwhitneyu, rankdata

from greywhale.demo.practice import tables
from greywhale.files.arm import default_arm, load_arm
from greywhale.identify import identify
from greywhale.table import ParameterTable
from greywhale.trajectory.motion import Array
from greywhale.tune import tune
from greywhale.tune.model import Model, load_model
from tools.bench.figure import Figure
from tools.bench.tuning import practised
from tools.setup.console import ROOT

METHODS = ("gwo-woa-relative", "gwo-woa", "gwo-woa-printed", "gwo", "woa", "pso", "de", "cma-es", "random")
RIVAL = "de"
BUDGET = int(os.environ.get("GREYWHALE_BUDGET", "500"))
SEEDS = range(20)
SIGNIFICANCE = 0.05
TABLE = ROOT / "build" / "bench_tune_methods.md"


def identified() -> Model:
    """The default arm as its recordings show it."""
    with tempfile.TemporaryDirectory() as folder:
        fit, *checks = practised(default_arm(), Path(folder), 1)
        path = Path(folder) / "model.toml"
        identify([fit], load_arm("white_box"), validate=checks, tables=tables(ParameterTable.defaults())).save(path)
        return load_model(path, force=True)


def cost(model: Model, method: str, seed: int) -> float:
    """mrad, of all joints, as the search saw it."""
    outcome = tune(model, method=method, budget=BUDGET, seed=seed, report=searched, floors=False)
    if outcome.evaluations != BUDGET:
        raise RuntimeError(f"{method} spent {outcome.evaluations} evaluations instead of {BUDGET}")
    return 1e3 * sum(curve.cost[-1] for curve in outcome.curves)


def searched(what: str, fraction: float, note: str = "") -> None:
    """Ends a tuning when its search is over: the last judgement takes as long again and changes no curve."""
    if what == "judging":
        raise KeyboardInterrupt


def verdict(own: Array, other: Array) -> tuple[str, float]:
    """Against the rival: lower, higher or not told apart; and the chance of such a difference between equals."""
    chance = float(mannwhitneyu(own, other).pvalue)
    if chance >= SIGNIFICANCE:
        return "not told apart", chance
    return ("lower" if np.median(own) < np.median(other) else "higher"), chance


def table(costs: dict[str, Array]) -> str:
    """Markdown, the lowest median first."""
    ranks = rankdata(np.array(list(costs.values())), axis=0).mean(axis=1)
    rank = dict(zip(costs, ranks, strict=True))
    lines = [
        f"Cost in mrad, all joints, after {BUDGET} evaluations a joint; {len(SEEDS)} seeds.",
        "",
        f"| method | median | lowest to highest | mean rank of {len(costs)} | against `{RIVAL}` (Mann-Whitney) |",
        "|---|---|---|---|---|",
    ]
    for method in sorted(costs, key=lambda name: float(np.median(costs[name]))):
        own = costs[method]
        word, chance = verdict(own, costs[RIVAL])
        against = "" if method == RIVAL else f"{word}, p = {chance:.2g}"
        spread = f"{own.min():.1f} to {own.max():.1f}"
        lines.append(f"| {method} | {np.median(own):.1f} | {spread} | {rank[method]:.2f} | {against} |")
    return "\n".join(lines) + "\n"


def run() -> list[Figure]:
    model = identified()
    costs = {method: np.array([cost(model, method, seed) for seed in SEEDS]) for method in METHODS}
    TABLE.write_text(table(costs), encoding="utf-8")
    figures = []
    for method, own in costs.items():
        figures.append(Figure(f"tuning, {BUDGET} evaluations: {method}, median", float(np.median(own)), "mrad"))
        if method != RIVAL:
            word, chance = verdict(own, costs[RIVAL])
            figures.append(Figure(f"  chance that it equals {RIVAL} ({word})", chance, "p"))
    return figures
