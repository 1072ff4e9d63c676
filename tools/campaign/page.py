"""The page that publishes a campaign: docs/reliability.md."""

from __future__ import annotations

from collections.abc import Iterable

from tools.campaign.journal import identity
from tools.campaign.part import Part, Row

HEAD = """<!-- Written by `make campaign`; change the campaign, not this page. -->

# Reliability

What was attacked, how often, and what came of it. Every figure on this page was counted by `make campaign` on the code
whose digest stands below its table. A small share of the same campaign runs in every `make test`.

A violation is a trial that broke what the section says must hold.
"""


def write_table(rows: Iterable[Row]) -> str:
    """A Markdown table; the last column holds the worst figures and the counts."""
    lines = ["| tried | trials | violations | worst | seen |", "|---|--:|--:|---|---|"]
    for row in rows:
        worst = ", ".join(f"{value:.4g} {name}" for name, value in row.worst.items())
        seen = ", ".join(f"{name} {count:,}" for name, count in row.counts.items())
        violations = f"**{row.violations:,}**" if row.violations else "0"
        lines.append(f"| {row.tried} | {row.trials:,} | {violations} | {worst} | {seen} |")
    return "\n".join(lines) + "\n"


def write_summary(results: Iterable[tuple[Part, list[Row]]]) -> str:
    """One line for each part."""
    lines = ["| | trials | violations |", "|---|--:|--:|"]
    for part, rows in results:
        trials, violations = sum(row.trials for row in rows), sum(row.violations for row in rows)
        anchor = part.title.lower().replace(" ", "-").replace(",", "")
        lines.append(f"| [{part.title}](#{anchor}) | {trials:,} | {violations:,} |")
    return "\n".join(lines) + "\n"


def write_page(results: list[tuple[Part, list[Row]]]) -> str:
    sections = [
        f"## {part.title}\n\n{' '.join(part.holds.split())}\n\n{write_table(rows)}\n"
        f"`python -m tools.campaign {part.name}`; digest `{identity(part)}`.\n"
        for part, rows in results
    ]
    return "\n".join([HEAD, write_summary(results), *sections])
