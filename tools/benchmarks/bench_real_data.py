"""How well one joint of three real rigs is predicted: physics in the known controller against naive fits of the data.

The recordings are other people's and not part of this project; docs/real_data.md says where they come from. Their
folder is ../shared/data, or what GREYWHALE_REAL_DATA names. Writes the tables of that page to build/real_data.md.
"""

from __future__ import annotations

import sys

from greywhale.base.errors import UserError
from studies.real_data.compare import Comparison
from studies.real_data.study import ProductScore, by_halves, by_product, by_records, data_folder, read_sources
from studies.real_data.tables import comparison_table, model_table, product_table
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
