"""A comparison for people and programs: tables, one plain statement, JSON, CSV, and a picture of how ranks change."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TypedDict

from greywhale.base.errors import BadUsage
from greywhale.base.formats.whole import write_text
from greywhale.pictures.kinds import KINDS
from greywhale_paper.optimisers.comparison import Comparison, Duel
from greywhale_paper.optimisers.functions import Setting

FORMATS = (".csv", *KINDS)
RIVAL = "de"
# A method that changes its place by at least this many is named in the statement.
WORTH_SAYING = 2


class ComparisonFacts(TypedDict):
    dimensions: int
    budget: int  # evaluations of a run
    seeds: int  # runs of each method on each function
    seed: int
    median_cost: dict[str, dict[str, dict[str, float]]]  # setting, function, method
    mean_rank: dict[str, dict[str, float]]  # setting, method; 1 is best
    against_de: dict[str, dict[str, Duel]]  # setting, method (Mann-Whitney, 5 %)
    statement: str


def check_format(path: Path) -> None:
    if path.suffix.lower() not in FORMATS:
        raise BadUsage(f"{path}: reports end in {', '.join(FORMATS)}.")


def write_report(path: Path, comparison: Comparison) -> None:
    """The costs of all runs (.csv), or the picture."""
    check_format(path)
    if path.suffix.lower() == ".csv":
        write_text(path, _csv(comparison))
    else:
        _draw(path, comparison)


def as_dict(comparison: Comparison) -> ComparisonFacts:
    """Everything but the single runs, for JSON."""
    plan = comparison.plan
    medians = comparison.medians
    return {
        "dimensions": plan.dimensions,
        "budget": plan.budget,
        "seeds": plan.runs,
        "seed": plan.seed,
        "median_cost": {
            setting: {
                function: {method: float(medians[f, s, m]) for m, method in enumerate(plan.methods)}
                for f, function in enumerate(plan.functions)
            }
            for s, setting in enumerate(plan.settings)
        },
        "mean_rank": {setting: comparison.mean_ranks(setting) for setting in plan.settings},
        "against_de": {setting: comparison.duels(setting, RIVAL) for setting in plan.settings if RIVAL in plan.methods},
        "statement": statement(comparison),
    }


def text(comparison: Comparison) -> str:
    """Medians a setting, mean ranks, and the statement."""
    blocks = [_medians(comparison, setting) for setting in comparison.plan.settings]
    return "\n\n".join([*blocks, _ranks(comparison), statement(comparison)])


def statement(comparison: Comparison) -> str:
    """In words: who leads, how the order changes once the minimum is not at the origin, and how all compare with DE."""
    plan = comparison.plan
    sentences = [_leaders(comparison, setting) for setting in plan.settings]
    if "plain" in plan.settings:
        sentences += [_change(comparison, setting) for setting in plan.settings if setting != "plain"]
    if RIVAL in plan.methods:
        sentences += [_duels(comparison, setting) for setting in plan.settings]
    return "\n".join(sentence for sentence in sentences if sentence)


def _leaders(comparison: Comparison, setting: Setting) -> str:
    ranks = comparison.mean_ranks(setting)
    order = sorted(ranks, key=lambda method: ranks[method])
    named = ", ".join(f"{method} ({ranks[method]:.2f})" for method in order)
    return f"On {setting} functions, by mean rank: {named}."


def _change(comparison: Comparison, setting: Setting) -> str:
    before, after = comparison.places("plain"), comparison.places(setting)
    fallen = [m for m in comparison.plan.methods if after[m] - before[m] >= WORTH_SAYING]
    risen = [m for m in comparison.plan.methods if before[m] - after[m] >= WORTH_SAYING]
    if not fallen and not risen:
        return f"From plain to {setting} functions no method changes its place by {WORTH_SAYING} or more."
    moves = [f"{m} falls from place {before[m]} to {after[m]}" for m in fallen]
    moves += [f"{m} rises from place {before[m]} to {after[m]}" for m in risen]
    told = f"From plain to {setting} functions {', '.join(moves)}."
    if fallen and setting == "shifted":
        told += " What falls was helped by minima at the origin of the coordinates."
    return told


def _duels(comparison: Comparison, setting: Setting) -> str:
    count = len(comparison.plan.functions)
    duels = comparison.duels(setting, RIVAL)
    rows = [f"{method} {duel.better}/{duel.worse}/{duel.undecided}" for method, duel in duels.items()]
    if not rows:
        return ""
    return (
        f"Better/worse/undecided against {RIVAL} on {count} {setting} functions (Mann-Whitney, "
        f"Holm, 5 %): {', '.join(rows)}."
    )


def _medians(comparison: Comparison, setting: Setting) -> str:
    plan = comparison.plan
    medians = comparison.medians[:, plan.settings.index(setting)]
    widths = [max(len(method), 9) for method in plan.methods]
    name = max(len(function) for function in (*plan.functions, "function"))
    lines = [
        f"{setting}: median of the lowest costs of {plan.runs} runs, {plan.dimensions} dimensions, "
        f"{plan.budget} evaluations",
        f"{'function':<{name}}  " + "  ".join(f"{m:>{w}}" for m, w in zip(plan.methods, widths, strict=True)),
    ]
    for function, row in zip(plan.functions, medians, strict=True):
        cells = "  ".join(f"{value:>{w}.3g}" for value, w in zip(row, widths, strict=True))
        lines.append(f"{function:<{name}}  {cells}")
    return "\n".join(lines)


def _ranks(comparison: Comparison) -> str:
    settings = comparison.plan.settings
    ranks = [comparison.mean_ranks(setting) for setting in settings]
    name = max(len(method) for method in (*comparison.plan.methods, "mean rank"))
    lines = [f"{'mean rank':<{name}}  " + "  ".join(f"{setting:>8}" for setting in settings)]
    for method in comparison.plan.methods:
        lines.append(f"{method:<{name}}  " + "  ".join(f"{rank[method]:>8.2f}" for rank in ranks))
    return "\n".join(lines)


def _csv(comparison: Comparison) -> str:
    plan = comparison.plan
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["function", "setting", "method", "dimensions", "budget", "seed", "run", "cost"])
    for function in plan.functions:
        for setting in plan.settings:
            for method in plan.methods:
                for run, cost in enumerate(comparison.of(function, setting, method)):
                    writer.writerow(
                        [function, setting, method, plan.dimensions, plan.budget, plan.seed, run, repr(float(cost))]
                    )
    return out.getvalue()


def _draw(path: Path, comparison: Comparison) -> None:
    # Matplotlib takes a second to import, and most comparisons draw nothing.
    from greywhale.pictures.page import save, style
    from greywhale_paper.pictures.ranks import plot_ranks

    plan = comparison.plan
    counts = {"functions": len(plan.functions), "dimensions": plan.dimensions, "evaluations": plan.budget}
    title = ", ".join(f"{name}: {count}" for name, count in (counts | {"runs": plan.runs}).items())
    with style():
        save(plot_ranks({setting: comparison.mean_ranks(setting) for setting in plan.settings}, title), path)
