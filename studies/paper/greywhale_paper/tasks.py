"""The pieces of work that a request asks for, what takes longest first. None needs another's result."""

from __future__ import annotations

from typing import Any

from greywhale.base.study import Task
from greywhale_paper.request import Request
from greywhale_paper.work import bench, errata, findings, grey_box, on_the_bench, optimisers, readings
from greywhale_paper.work.arms import DEFAULT, OTHER_HAND, STICKY
from greywhale_paper.work.motions import PERIOD_MS, printed

# The board's own control period, at which greywhale's own controllers run and the data sets are recorded.
OWN_PERIOD_MS = 1
# What was tried on the bench without a tuning here: controllers, control period.
UNTUNED = tuple((name, period) for name in ("before_tuning", "table_10") for period in (PERIOD_MS, OWN_PERIOD_MS))
# Ways to read the paper's identification, and its optimiser as good as it can be.
IDENTIFICATIONS = ("paper", "paper-started", "gwo-woa")


def tasks_of(request: Request) -> list[Task]:
    """All of them; their keys say what they are."""
    data = {"seconds": request.logged_s, "period_ms": OWN_PERIOD_MS}
    first = request.seed
    tasks = [
        Task(
            f"default {seed}",
            on_the_bench.follow_as_default,
            seed,
            {**data, "budget": request.tuning_budget, "traces": seed == first},
        )
        for seed in request.few_seeds
    ]
    tasks += [
        Task(f"functions {name}", optimisers.compare_on, first, {"function": name, "runs": request.function_runs})
        for name in optimisers.functions()
    ]
    tasks += [
        Task(
            f"paper {arm} {seed}",
            on_the_bench.follow_as_paper,
            seed,
            {**data, "traces": arm == DEFAULT and seed == first, "arm": arm},
        )
        for arm in (DEFAULT, STICKY)
        for seed in request.every_seed
    ]
    tasks += [
        Task(
            f"identified {method} {arm} {seed}",
            on_the_bench.identify_on_bench,
            seed,
            {**data, "method": method, "arm": STICKY if arm == OTHER_HAND else arm, "hand": int(arm == OTHER_HAND)},
        )
        for arm, methods, seeds in (
            *((arm, IDENTIFICATIONS[1:], request.every_seed) for arm in (DEFAULT, STICKY)),
            (OTHER_HAND, IDENTIFICATIONS, request.every_seed),
            *((arm, IDENTIFICATIONS, request.arm_seeds) for arm in request.drawn),
        )
        for method in methods
        for seed in seeds
    ]
    tasks += [
        Task(f"errata {name}", errata.effect, first, {"names": list(names)}) for name, names in errata.cases().items()
    ]
    return [*tasks, *_optimisers(request, data), *_grey_box(request), *_experiments(first), *_findings(request, data)]


def _optimisers(request: Request, data: dict[str, Any]) -> list[Task]:
    tasks = []
    for method in optimisers.METHODS:
        for seed in request.every_seed:
            tasks.append(Task(f"identify {method} {seed}", optimisers.identify_with, seed, {**data, "method": method}))
            tasks.append(Task(f"sets {method} {seed}", optimisers.tune_with, seed, {"method": method}))
    return tasks


def _grey_box(request: Request) -> list[Task]:
    tasks = [
        Task(
            f"grey box {strategy} {seed}",
            grey_box.tune_on_grey_box,
            seed,
            {"strategy": strategy, "traces": seed == request.seed},
        )
        for strategy in grey_box.STRATEGIES
        for seed in request.every_seed
    ]
    tasks.append(Task("grey box printed", grey_box.print_on_grey_box, request.seed))
    return [*tasks, Task("floors", grey_box.floors, request.seed)]


def _experiments(seed: int) -> list[Task]:
    """What nobody tuned here: the controllers from before at both periods, and those of Table 10."""
    return [
        Task(
            f"bench {arm} {name} {period}",
            bench.try_controllers,
            0,
            {"rows": printed(name).tolist(), "period_ms": period, "arm": arm},
        )
        for arm in (DEFAULT, STICKY)
        for name, period in UNTUNED
    ]


def _findings(request: Request, data: dict[str, Any]) -> list[Task]:
    first = request.seed
    return [
        *(
            Task(
                one.key,
                readings.judge_reading,
                first,
                {"law": one.law, "friction": one.friction, "period_ms": one.period_ms},
            )
            for one in request.readings
        ),
        Task("reading floors", readings.floors, first),
        Task("silent", readings.silent, first),
        Task("periods", findings.periods, first),
        Task("friction", findings.friction, first),
        *(Task(f"objective {seed}", findings.objective, seed) for seed in request.every_seed),
        Task("identifiability", findings.identifiability, first, data),
        Task("white box", findings.white_box_at_rest, first),
    ]
