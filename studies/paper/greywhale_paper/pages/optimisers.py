"""GWO-WOA beside what it is made of, beside established optimisers and beside chance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from greywhale.identify.pack_search import BUDGET as IDENTIFYING
from greywhale.tune.paper import BUDGET
from greywhale_paper.optimisers.significance import SIGNIFICANCE, against, against_each, fewest, mean_ranks
from greywhale_paper.pages.document import Chapter, Entry, Picture, Row, Sheet, Status, words
from greywhale_paper.pages.found import Found
from greywhale_paper.pages.numbers import several
from greywhale_paper.pictures import curves
from greywhale_paper.work.optimisers import METHODS, SETTINGS

OURS = METHODS[0]
SAID = {
    "gwo-woa": "paper's GWO-WOA, a 2 to 0",
    "gwo-woa-printed": "paper's GWO-WOA, a 2 to 1",
    "gwo-woa-relative": "greywhale's GWO-WOA",
    "gwo": "GWO",
    "woa": "WOA",
    "pso": "PSO",
    "de": "DE",
    "cma-es": "CMA-ES",
    "random": "random",
}

DRIFT = words(
    "The box of the 20 values begins at 0, towards which GWO and WOA drift by themselves, and the few arms in it "
    "that move lie near there. So this problem rewards them as functions with the minimum at the origin do."
)


def chapter(found: Found) -> Chapter:
    """The paper claims that GWO-WOA is superior, and refers to another publication for it."""
    ranks = all_ranks(found)
    picture = curves.ranks(
        {name: {SAID[m]: rank for m, rank in one.items()} for name, one in ranks.items()}, "Mean ranks"
    )
    return Chapter(
        "The optimiser",
        (
            Entry(
                "",
                "Identification: 20 motor values on data set 1",
                Status.OURS,
                (_table(costs_of(found, "identify"), found), _say(costs_of(found, "identify"), IDENTIFYING), DRIFT),
            ),
            Entry(
                "",
                "Tuning: the sets of the paper's grey-box arm",
                Status.OURS,
                (_table(costs_of(found, "sets"), found), _say(costs_of(found, "sets"), BUDGET)),
            ),
            Entry(
                "",
                "Standard functions, plain and shifted",
                Status.OURS,
                (
                    Picture(picture, "The lower the better. Shifted: the minimum is not at the origin."),
                    _functions(found),
                ),
            ),
        ),
    )


def costs_of(found: Found, problem: str) -> dict[str, list[float]]:
    """Method -> the lowest cost of every seed."""
    return {method: [run["cost"] for run in runs] for method, runs in found.problem(problem).items()}


def all_ranks(found: Found) -> dict[str, dict[str, float]]:
    """Problem -> method -> mean rank."""
    ranks = {f"{setting} functions": function_ranks(found, setting) for setting in SETTINGS}
    return ranks | {
        "identification": mean_ranks(costs_of(found, "identify")),
        "tuning of sets": mean_ranks(costs_of(found, "sets")),
    }


def function_ranks(found: Found, setting: str) -> dict[str, float]:
    """Over all functions and runs."""
    each = [mean_ranks(one[setting]) for one in found.functions().values()]
    return {method: float(np.mean([one[method] for one in each])) for method in METHODS}


def _table(costs: Mapping[str, list[float]], found: Found) -> Sheet:
    ranks, verdicts = mean_ranks(costs), against(costs, OURS)
    rows = [
        Row(SAID[name], (several(costs[name], ".4g"), f"{ranks[name]:.2f}", str(verdicts.get(name, ""))))
        for name in sorted(costs, key=lambda name: ranks[name])
    ]
    return Sheet(
        ("method", f"lowest cost, {found.seeds}", "mean rank", "paper's GWO-WOA (2 to 0) against it"),
        rows,
        notes=(
            f"Mann-Whitney over the seeds with Holm's correction, {100 * SIGNIFICANCE:g} %. Equal budgets; a pack of "
            "10 except for CMA-ES. Identification: summed MSE, rad². Tuning: J summed over the joints.",
        ),
    )


def _say(costs: Mapping[str, list[float]], budget: int) -> Any:
    verdicts = against(costs, OURS)
    lower, higher, same = (
        [SAID[name] for name, one in verdicts.items() if one.word == word]
        for word in ("lower", "higher", "not told apart")
    )
    if len(costs[OURS]) < (needed := fewest(len(verdicts))):
        return words(
            f"With {len(costs[OURS])} seeds none of {len(verdicts)} differences can be told from chance, however big; "
            f"take {needed}."
        )
    found = (("finds lower costs than", lower), ("finds higher costs than", higher), ("is not told apart from", same))
    parts = [f"{what} {', '.join(names)}" for what, names in found if names]
    return words(f"With {budget} evaluations the paper's GWO-WOA {'; it '.join(parts)}.")


def _functions(found: Found) -> Sheet:
    rows = []
    for setting in SETTINGS:
        ranks = function_ranks(found, setting)
        every = against_each({name: one[setting] for name, one in found.functions().items()}, OURS)
        duels = {name: [duel[name].word for duel in every.values()] for name in METHODS[1:]}
        rows.append(Row(setting))
        for name in sorted(METHODS, key=lambda name: ranks[name]):
            words_ = duels.get(name)
            tally = "" if words_ is None else " / ".join(str(words_.count(word)) for word in WORDS)
            rows.append(Row(SAID[name], (f"{ranks[name]:.2f}", tally)))
    runs = found.request.function_runs
    return Sheet(
        ("method", "mean rank", "paper's GWO-WOA (2 to 0) is lower / higher / not told apart, functions"),
        rows,
        notes=(
            f"{len(found.functions())} functions in 10 dimensions, 500 evaluations, {runs} runs each.",
            "Holm's correction is over all pairs of a setting.",
        ),
    )


WORDS = ("lower", "higher", "not told apart")
