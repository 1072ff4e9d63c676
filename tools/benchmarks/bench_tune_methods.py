"""Which optimiser tunes best: several at equal budgets in the stages of the default, many seeds, five identified arms.

What is compared is the cost of what the search found, judged anew with other sensor noise: a search knows its own noise
by heart, and the neighbours of a joint in the row in which it was best. The cost is the sum over the joints, where 0 is
what an ideal controller reaches and 1 a joint what there was before. The table goes to build/bench_tune_methods.md as
well.
"""

from __future__ import annotations

import os
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from scipy.stats import rankdata, wilcoxon

from greywhale.arm import ArmParameters
from greywhale.base import study
from greywhale.base.types import Floats, show_no_progress
from greywhale.cli.story.practice import tables
from greywhale.files.arm import default_arm, load_arm
from greywhale.identify import identify
from greywhale.optimise import DEFAULT
from greywhale.optimise.significance import holm
from greywhale.protocol.table import ParameterTable
from greywhale.tune.default import DefaultMethod
from greywhale.tune.model import Model, load_model
from greywhale.tune.request import TuningRequest
from greywhale.tune.search.journal import TuningJournal
from tools import ROOT
from tools.benchmarks.figure import Figure
from tools.benchmarks.study import repeat, threads
from tools.benchmarks.tuning import practised
from tools.support.recordings import random_arm

METHODS = tuple(os.environ.get("GREYWHALE_METHODS", "gwo-woa-relative,gwo-woa,gwo-woa-printed,random").split(","))
OURS = METHODS[0]
BUDGET = int(os.environ.get("GREYWHALE_BUDGET", "3000"))
SEEDS = range(int(os.environ.get("GREYWHALE_SEEDS", "20")))
ARMS = range(int(os.environ.get("GREYWHALE_ARMS", "5")))  # 0 is the default arm, the others are drawn at random
OTHER_SEED = 999  # of the sensor noise of the judgement
SIGNIFICANCE = 0.05
TABLE = ROOT / "build" / "bench_tune_methods.md"


def identified(seed: int, number: int) -> str:
    """The model.toml of an arm as its recordings show it."""
    arm: ArmParameters = default_arm() if number == 0 else random_arm(number)
    with tempfile.TemporaryDirectory() as folder:
        fit, *checks = practised(arm, Path(folder), seed)
        path = Path(folder) / "model.toml"
        found = identify([fit], load_arm("white_box"), validate=checks, tables=tables(ParameterTable.defaults()))
        if not found.complete:
            raise KeyboardInterrupt
        found.save(path)
        return path.read_text(encoding="utf-8")


@cache
def judged_model(text: str) -> tuple[Model, DefaultMethod]:
    """A model, and the judge of what is found for it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.toml"
        path.write_text(text, encoding="utf-8")
        model = load_model(path, force=True, samples=1)  # and looser gears, as in the search
    return model, method_of(model, DEFAULT, OTHER_SEED, 1)


def method_of(model: Model, method: str, seed: int, budget: int) -> DefaultMethod:
    """The stages of the default method with an optimiser, before its search."""
    before = model.controllers
    return DefaultMethod(
        TuningRequest(model, "both", method, budget, seed, threads(), before, {}, show_no_progress, floors=False)
    )


def cost(seed: int, model: str, method: str, budget: int) -> float:
    """What a method found with one seed and so many evaluations for a model.toml, judged with other noise."""
    known, judge = judged_model(model)
    search = method_of(known, method, seed, budget)
    with TuningJournal(None, {}) as book:
        search.search(book)
    return float(judge.costs(search.found.best[None]).sum())


def verdicts(own: Floats, others: dict[str, Floats]) -> dict[str, str]:
    """Ours against each other, paired by arm and seed: lower, higher or not told apart, and Holm's p."""
    words = {}
    chances = holm([float(wilcoxon(own, other).pvalue) for other in others.values()])
    for (method, other), chance in zip(others.items(), chances, strict=True):
        told = "lower" if np.median(own / other) < 1.0 else "higher"
        words[method] = f"{told if chance < SIGNIFICANCE else 'not told apart'}, p = {chance:.2g}"
    return words


def table(found: list[dict[str, Floats]]) -> str:
    """Markdown, the lowest mean rank first."""
    together = {method: np.concatenate([one[method] for one in found]) for method in METHODS}
    ranks = rankdata(np.array(list(together.values())), axis=0).mean(axis=1)
    rank = dict(zip(together, ranks, strict=True))
    against = verdicts(together[OURS], {method: together[method] for method in METHODS if method != OURS})
    arms = " | ".join("default" if number == 0 else f"random {number}" for number in ARMS)
    lines = [
        f"Cost of all joints after {BUDGET} evaluations, median of {len(SEEDS)} seeds (highest minus lowest).",
        "",
        f"| method | {arms} | mean rank of {len(METHODS)} | {OURS} against it (Wilcoxon, Holm) |",
        "|" + "---|" * (len(found) + 3),
    ]
    for method in sorted(METHODS, key=lambda name: rank[name]):
        medians = " | ".join(f"{np.median(one[method]):.3f} ({np.ptp(one[method]):.3f})" for one in found)
        lines.append(f"| {method} | {medians} | {rank[method]:.2f} | {against.get(method, '')} |")
    return "\n".join(lines) + "\n"


def run() -> list[Figure]:
    names = ["default arm" if number == 0 else f"random arm {number}" for number in ARMS]
    arms = [
        study.Task(name, identified, number + 1, {"number": number}) for name, number in zip(names, ARMS, strict=True)
    ]
    models = repeat("tune_methods_arms", arms)
    tasks = {
        (name, method, seed): study.Task(
            f"{name}, {method}, seed {seed}", cost, seed, {"model": model, "method": method, "budget": BUDGET}
        )
        for seed in SEEDS
        for name, model in models.items()
        for method in METHODS
    }
    costs = repeat("tune_methods", list(tasks.values()))
    found = [
        {method: np.array([costs[tasks[name, method, seed].key] for seed in SEEDS]) for method in METHODS}
        for name in names
    ]
    TABLE.write_text(table(found), encoding="utf-8")
    figures = []
    for name, of_model in zip(names, found, strict=True):
        for method, own in of_model.items():
            head = f"{name}, {BUDGET} evaluations: {method}"
            figures.append(Figure(f"{head}, median cost", float(np.median(own)), "x of before"))
    together = {method: np.concatenate([one[method] for one in found]) for method in METHODS}
    for method in METHODS[1:]:
        ratio = float(np.median(together[OURS] / together[method]))
        figures.append(Figure(f"{OURS} / {method}, median of all", ratio, "x", "<= 1", ratio <= 1.0))
    return figures
