"""Tuning as a whole: a method searches and judges; journal and outcome are the same for all methods."""

from __future__ import annotations

from pathlib import Path

from greywhale.base.errors import MOST_SEED, MOST_WORKERS, BadUsage, require_within
from greywhale.base.types import Controllers, NotedProgress, show_no_progress
from greywhale.files.trajectory import Trajectory
from greywhale.loop.controllers import check_controllers
from greywhale.optimise import METHODS as OPTIMISERS
from greywhale.protocol.joints import ALL
from greywhale.tune import default, paper
from greywhale.tune.default import DefaultMethod
from greywhale.tune.limits import TUNING_LIMITS, TuningLimits
from greywhale.tune.method import Judgement, Method
from greywhale.tune.model import Model
from greywhale.tune.paper import PaperMethod
from greywhale.tune.request import TuningRequest
from greywhale.tune.result import TuningResult, curves_of
from greywhale.tune.search.journal import TuningJournal
from greywhale.tune.search.space import Bounds, check_bounds, check_strategy

DEFAULT_STRATEGY = "both"
DEFAULT_BUDGET = default.BUDGET
MOST_BUDGET = 1_000_000  # takes days
METHODS = ("default", "paper", *OPTIMISERS)
_UNFINISHED = "interrupted: the best so far by the search's own cost; margins and other motions were not looked at"


def check_request(
    *,
    strategy: str = DEFAULT_STRATEGY,
    method: str = "default",
    budget: int | None = None,
    seed: int = 0,
    threads: int = 0,
    bounds: Bounds | None = None,
) -> None:
    """Refuse, with exit code 2, a request that fits no model at all."""
    check_strategy(strategy)
    if method not in METHODS:
        raise BadUsage(f"there is no method {method!r}; there are {', '.join(METHODS)}.")
    if budget is not None:
        require_within("budget", budget, 1, MOST_BUDGET)
    require_within("seed", seed, 0, MOST_SEED)
    require_within("threads", threads, 0, MOST_WORKERS)
    if bounds and method == "paper":
        raise BadUsage("the paper's method has bounds of its own; leave out others.")
    check_bounds(strategy, bounds or {})


def tune(
    model: Model,
    *,
    strategy: str = DEFAULT_STRATEGY,
    method: str = "default",
    budget: int | None = None,
    seed: int = 0,
    threads: int = 0,
    start: Controllers | None = None,
    bounds: Bounds | None = None,
    journal: Path | None = None,
    resume: bool = False,
    report: NotedProgress | None = None,
    judging: TuningLimits = TUNING_LIMITS,
    motion: Trajectory | None = None,
) -> TuningResult:
    """Tune the four controllers of a model.

    `budget` counts sets of four candidates, each tried on all plants and motions. The first set is `start`, the
    controller from before: int32 (4, 13), by default that of the model's table. `journal` is a file that keeps every
    cost; with `resume` the tuning goes on from it. `threads` (0: all cores) changes no bit. `judging` holds
    all limits, and who has the last word. `motion` is a motion to train on in the place of the usual ones (default
    method only, without a journal). After an interrupt (KeyboardInterrupt) the best so far comes back at once, with
    `complete` False and not judged; if nothing was evaluated yet, the interrupt is raised again. Raises UserError.
    """
    check_request(strategy=strategy, method=method, budget=budget, seed=seed, threads=threads, bounds=bounds)
    if method == "paper" and model.arm.joints_in_use != ALL:
        raise BadUsage("the paper's method is for arms with all four joints; use --method default.")
    usual = paper.BUDGET if method == "paper" else DEFAULT_BUDGET
    task = TuningRequest(
        model=model,
        strategy=strategy,
        method=method,
        budget=usual if budget is None else budget,
        seed=seed,
        threads=threads,
        before=check_controllers(model.controllers if start is None else start)[0],
        bounds=dict(bounds or {}),
        report=report or show_no_progress,
        judging=judging,
        motion=motion,
    )
    return _run(task, PaperMethod(task) if method == "paper" else DefaultMethod(task), journal, resume)


def _run(task: TuningRequest, method: Method, journal: Path | None, resume: bool) -> TuningResult:
    """Search and judge; an interrupt on the way ends it with the best so far."""
    with TuningJournal(journal, task.facts() | method.facts(), resume) as book:
        try:
            method.search(book)
            return _outcome(task, method, method.judge(), complete=True)
        except KeyboardInterrupt:
            if not method.found.evaluations:
                raise
    found = method.found
    cost = tuple(map(float, found.cost))
    best = Judgement(found.best.copy(), method.cost_before(), cost, (_UNFINISHED,))
    return _outcome(task, method, best, complete=False)


def _outcome(task: TuningRequest, method: Method, judged: Judgement, complete: bool) -> TuningResult:
    return TuningResult(
        model=task.model,
        table=method.table,
        strategy=task.strategy,
        method=task.method,
        seed=task.seed,
        budget=task.budget,
        evaluations=method.found.evaluations,
        complete=complete,
        before=task.before,
        after=judged.after,
        cost_before=judged.cost_before,
        cost_after=judged.cost_after,
        curves=curves_of(method.found),
        margins_before=judged.margins_before,
        margins=judged.margins,
        held_out=judged.held_out,
        worse=judged.worse,
        notes=judged.notes,
    )
