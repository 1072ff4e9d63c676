"""How well one joint of three real rigs is predicted: physics in the known controller against naive fits of the data.

The recordings are other people's and not part of this project; docs/real_data.md says where they come from. Their
folder is ../shared/data, or what GREYWHALE_REAL_DATA names. Writes the tables of that page to build/real_data.md.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from greywhale.base.errors import UserError
from studies.real_data.compare import Comparison
from studies.real_data.study import ProductScore, by_halves, by_product, by_records, data_folder, read_sources
from tools import ROOT
from tools.benchmarks.figure import Figure

PAGE = ROOT / "build" / "real_data.md"


def figures_of(comparison: Comparison) -> list[Figure]:
    """Physics in the loop, beside the better of the two lags from leader to follower."""
    return [
        Figure(
            _name(comparison.title if comparison.title != score.record else "first half", score.record),
            100 * score.physics_loop,
            "% of range",
            f"< {100 * score.best_naive:.2f} (naive)",
            score.physics_loop < score.best_naive,
        )
        for score in comparison.scores
    ]


def figure_of(score: ProductScore) -> Figure:
    fitted = score.fitted if score.fitted != score.judged else "first half"
    return Figure(_name(f"greywhale identify, {fitted}", score.judged), 100 * score.loop, "% of range")


def _name(fitted: str, judged: str) -> str:
    return f"{fitted} -> {judged}"


def run() -> list[Figure]:
    try:
        sources = read_sources(data_folder())
    except UserError as error:
        print(error.message, file=sys.stderr)
        return []
    halves, others, products = list(by_halves(sources)), list(by_records(sources)), list(by_product(sources))
    PAGE.parent.mkdir(exist_ok=True)
    sections = (
        comparison_table(halves),
        comparison_table(others),
        product_table(products),
        model_table([*halves, *others]),
    )
    PAGE.write_text("\n\n".join(sections) + "\n", encoding="utf-8")
    figures = [figure for comparison in (*halves, *others) for figure in figures_of(comparison)]
    return [*figures, *(figure_of(score) for score in products)]


HEAD = (
    "| fitted to | judged on | range, rad | first order | second order | linear motor | physics "
    "| linear motor, windows | physics, windows |\n|---|---|---|---|---|---|---|---|---|"
)


def comparison_table(comparisons: Sequence[Comparison]) -> str:
    """Errors in percent of the joint's range, a row a judged record."""
    rows = [HEAD]
    for comparison in comparisons:
        for score in comparison.scores:
            same = comparison.title == score.record
            names = ("first half", score.record) if same else (comparison.title, score.record)
            errors = (
                *(score.first_order, score.second_order, score.linear_loop, score.physics_loop),
                *(score.linear_windows, score.physics_windows),
            )
            rows.append("| " + " | ".join([*names, f"{score.range_rad:.2f}", *(percent(one) for one in errors)]) + " |")
    return "\n".join(rows)


def product_table(scores: Sequence[ProductScore]) -> str:
    rows = ["| fitted to | judged on | in the loop | windows |", "|---|---|---|---|"]
    for one in scores:
        fitted = "first half" if one.fitted == one.judged else one.fitted
        rows.append(f"| {fitted} | {one.judged} | {percent(one.loop)} | {percent(one.windows)} |")
    return "\n".join(rows)


def model_table(comparisons: Sequence[Comparison]) -> str:
    """What was found, a row a fit."""
    rows = ["| fitted to | model |", "|---|---|"]
    for comparison in comparisons:
        values = ", ".join(f"{name} {_rounded(value)}" for name, value in comparison.model.values.items())
        rows.append(f"| {comparison.title} | {values} |")
    return "\n".join(rows)


def _rounded(value: float) -> str:
    return f"{value:.3g}" if abs(value) > 1e-6 else "0"


def percent(share: float) -> str:
    return f"{100 * share:.2f}" if share < 0.1 else f"{100 * share:.1f}" if share < 10 else "runs away"
