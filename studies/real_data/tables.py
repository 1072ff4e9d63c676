"""The study's results as Markdown tables."""

from __future__ import annotations

from collections.abc import Sequence

from studies.real_data.compare import Comparison
from studies.real_data.study import ProductScore

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
