"""Methods side by side: equal budgets, many runs, standard functions, plain and moved away from the origin.

Every run's problem and random numbers follow from (seed, run, function, setting, method) alone. So the result depends
neither on the number of processes nor on which other methods and functions take part. All methods get the same
problems.
"""

from __future__ import annotations

import zlib
from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.base.errors import MOST_SEED, BadUsage, require_within
from greywhale.base.study import SerialWorkers, Task, Workers, run_study
from greywhale.base.types import Floats, Progress
from greywhale.optimise import METHODS, Optimiser, create, minimise
from greywhale_paper.optimisers.functions import FUNCTIONS, SETTINGS, Setting, place
from greywhale_paper.optimisers.nevergrad_choice import NevergradChoice

# What a comparison knows beside greywhale's own methods: those of packages that are not installed by default.
PEERS: dict[str, type[Optimiser]] = {NevergradChoice.name: NevergradChoice}
COMPARED = METHODS | PEERS
# Evaluations that a worker does in one go: short enough for a smooth progress bar, long enough to be worth a message.
PART = 5000


@dataclass(frozen=True)
class Plan:
    """The plan of a comparison. With `pack` None every method keeps its own size: 10, CMA-ES 4 + 3 ln d, ngopt 1."""

    functions: tuple[str, ...] = tuple(FUNCTIONS)
    settings: tuple[Setting, ...] = ("plain", "shifted")
    methods: tuple[str, ...] = tuple(METHODS)
    dimensions: int = 10
    budget: int = 500
    runs: int = 25
    seed: int = 0
    pack: int | None = None

    def check(self) -> None:
        """Refuse what cannot be compared, in one sentence."""
        for what, chosen, known in (
            ("function", self.functions, FUNCTIONS),
            ("setting", self.settings, SETTINGS),
            ("method", self.methods, COMPARED),
        ):
            _check_names(what, chosen, tuple(known))
        require_within("dimensions", self.dimensions, 2, 1000)
        require_within("budget", self.budget, 1, 10_000_000)
        require_within("seeds", self.runs, 1, 100_000)
        require_within("seed", self.seed, 0, MOST_SEED)
        if self.pack is not None:
            require_within("pack", self.pack, 1, 10_000)
        for method in self.methods:
            try:
                box = np.zeros(self.dimensions), np.ones(self.dimensions)
                create(COMPARED[method], *box, budget=self.budget, pack=self.pack).close()
            except ValueError as error:
                raise BadUsage(f"{error}.") from None

    @property
    def evaluations(self) -> int:
        """How often cost functions are evaluated in all."""
        return len(self.functions) * len(self.settings) * len(self.methods) * self.runs * self.budget


def _check_names(what: str, chosen: tuple[str, ...], known: tuple[str, ...]) -> None:
    if not chosen:
        raise BadUsage(f"no {what} was chosen; there are {', '.join(known)}.")
    for name in chosen:
        if name not in known:
            raise BadUsage(f"there is no {what} {name!r}; there are {', '.join(known)}.")
        if chosen.count(name) > 1:
            raise BadUsage(f"{what} {name!r} was chosen twice.")


@dataclass(frozen=True)
class Duel:
    """On how many functions a method's costs are lower, higher, or not told apart from a rival's."""

    better: int
    worse: int
    undecided: int


@dataclass(frozen=True)
class Comparison:
    """`costs[function, setting, method, run]`: the lowest cost found, in the plan's order."""

    plan: Plan
    costs: Floats

    @property
    def medians(self) -> Floats:
        return np.median(self.costs, axis=3)

    def of(self, function: str, setting: Setting, method: str) -> Floats:
        plan = self.plan
        cell = (plan.functions.index(function), plan.settings.index(setting), plan.methods.index(method))
        costs: Floats = self.costs[cell]
        return costs

    def mean_ranks(self, setting: Setting) -> dict[str, float]:
        """Rank 1 is the lowest cost of a run; the mean over all functions and runs (ties share their ranks)."""
        from scipy.stats import rankdata

        costs = self.costs[:, self.plan.settings.index(setting)]
        ranks = rankdata(costs, axis=1).mean(axis=(0, 2))
        return dict(zip(self.plan.methods, map(float, ranks), strict=True))

    def places(self, setting: Setting) -> dict[str, int]:
        """The order of the mean ranks: 1 is the best method."""
        ranks = self.mean_ranks(setting)
        return {method: 1 + sum(other < rank for other in ranks.values()) for method, rank in ranks.items()}

    def duels(self, setting: Setting, rival: str) -> dict[str, Duel]:
        """Every other method against one rival, function by function."""
        # It imports scipy's statistics, which takes a moment.
        from greywhale_paper.optimisers.significance import against_each

        plan = self.plan
        costs = {function: {m: self.of(function, setting, m) for m in plan.methods} for function in plan.functions}
        found = against_each(costs, rival)
        words = {m: [found[function][m].word for function in plan.functions] for m in plan.methods if m != rival}
        return {m: Duel(w.count("higher"), w.count("lower"), w.count("not told apart")) for m, w in words.items()}


def compare(
    plan: Plan,
    executor: Executor | Workers | None = None,
    progress: Progress | None = None,
    results: Path | None = None,
) -> Comparison:
    """Run the plan, in this process or on an executor (base/study); the result does not depend on where. With a
    results file an interrupted comparison goes on.
    """
    plan.check()
    shape = (len(plan.functions), len(plan.settings), len(plan.methods))
    costs = np.empty((*shape, plan.runs))
    length = max(1, PART // plan.budget)
    parts = {
        (*cell, first): _part(plan, cell, range(first, min(first + length, plan.runs)))
        for cell in np.ndindex(*shape)
        for first in range(0, plan.runs, length)
    }
    tasks, workers = list(parts.values()), SerialWorkers() if executor is None else executor
    found = run_study(tasks, workers, results, progress, about=asdict(plan), what="comparing")
    for (*cell, first), part in parts.items():
        values = found[part.key]
        costs[tuple(cell)][first : first + len(values)] = values
    return Comparison(plan, costs)


def _part(plan: Plan, cell: tuple[int, ...], runs: range) -> Task:
    """Some runs of one method on one problem: a worker does them in one go."""
    function, setting, method = cell
    names = plan.functions[function], plan.settings[setting], plan.methods[method]
    arguments = {
        "function": names[0],
        "setting": names[1],
        "method": names[2],
        "first": runs.start,
        "count": len(runs),
        "dimensions": plan.dimensions,
        "budget": plan.budget,
        "pack": plan.pack,
    }
    return Task(" ".join((*names, f"{runs.start}-{runs.stop - 1}")), run_part, plan.seed, arguments)


def run_part(
    seed: int, function: str, setting: Setting, method: str, first: int, count: int, **plan: Any
) -> list[float]:
    """The lowest costs of some runs, in their order; the other arguments are the plan's."""
    whole = Plan(seed=seed, **plan)
    return [run_once(whole, function, setting, method, run) for run in range(first, first + count)]


def run_once(plan: Plan, function: str, setting: Setting, method: str, run: int) -> float:
    """The lowest cost that one method finds in one run."""
    problem = place(FUNCTIONS[function], plan.dimensions, setting, _generator(plan.seed, run, function))
    return minimise(
        problem,
        problem.lower,
        problem.upper,
        method=COMPARED[method],
        budget=plan.budget,
        seed=_generator(plan.seed, run, function, setting, method),
        pack=plan.pack,
    ).cost


def _generator(seed: int, run: int, *names: str) -> np.random.Generator:
    return np.random.default_rng([seed, run, *(zlib.crc32(name.encode()) for name in names)])
