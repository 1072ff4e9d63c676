"""Optimisers side by side at the paper's budgets: on its two problems, and on standard functions plain and shifted."""

from __future__ import annotations

from typing import Any

import numpy as np

from greywhale.base.types import show_no_progress
from greywhale.files.arm import load_arm
from greywhale.identify.closed_loop import Loop
from greywhale.identify.data import prepare
from greywhale.identify.pack_search import BUDGET as IDENTIFYING
from greywhale.identify.paper import LOWER, UPPER, PaperSearch
from greywhale.optimise import minimise
from greywhale.tune.model import load_model
from greywhale.tune.paper import BUDGET, Loops
from greywhale.tune.search.lockstep import LockstepSearch, SearchState
from greywhale.tune.search.space import Space
from greywhale_paper.optimisers.comparison import Plan, compare
from greywhale_paper.optimisers.functions import FUNCTIONS, Setting
from greywhale_paper.work.bench import record_data
from greywhale_paper.work.motions import printed

# The paper's hybrid first, then what it is made of, then established others, then chance.
METHODS = ("gwo-woa", "gwo-woa-printed", "gwo-woa-relative", "gwo", "woa", "pso", "de", "cma-es", "random")
SETTINGS: tuple[Setting, ...] = ("plain", "shifted")


def identify_with(seed: int, seconds: float, period_ms: int, method: str) -> dict[str, Any]:
    """The lowest summed MSE (rad²) on data set 1 that a method finds, and where."""
    logs, tables = record_data(seconds, period_ms)
    table = tables[0]
    loop = Loop(prepare(logs[0], table["filter_shift"]), table, load_arm("white_box"))
    search = PaperSearch(load_arm("white_box"), [loop], 0, show_no_progress)
    lower, upper = np.tile(LOWER, 4), np.tile(UPPER, 4)
    best = minimise(search.costs, lower, upper, method=method, budget=IDENTIFYING, seed=seed)
    return {"cost": float(best.cost), "point": best.x.tolist()}


def tune_with(seed: int, method: str) -> dict[str, Any]:
    """The paper's J of the sets, summed over the joints of its grey-box arm, that a method finds."""
    model, before = load_model("grey_box", force=True), printed("before_tuning")
    loops = Loops(model, "mf", before, 1)
    found = SearchState.nothing(before)
    search = LockstepSearch(loops.costs, found)
    search.run(Space.paper("mf", before), stage="paper", method=method, budget=BUDGET, seed=(seed,))
    return {"cost": float(found.cost.sum()), "before": float(loops.costs(before[None]).sum())}


def compare_on(seed: int, function: str, runs: int) -> dict[str, Any]:
    """The lowest costs of all methods on one function: setting -> method -> runs."""
    plan = Plan(functions=(function,), settings=SETTINGS, methods=METHODS, runs=runs, seed=seed)
    comparison = compare(plan)
    return {
        "costs": {
            setting: {method: comparison.of(function, setting, method).tolist() for method in METHODS}
            for setting in SETTINGS
        }
    }


def functions() -> tuple[str, ...]:
    return tuple(FUNCTIONS)
