"""The page that publishes a campaign: docs/reliability.md."""

from __future__ import annotations

from collections.abc import Iterable

from tools.campaign.journal import ROOT, identity
from tools.campaign.part import Part, Row
from tools.link_generator.declaration import load

HEAD = """<!-- Written by `make campaign`; change the campaign, not this page. -->

# Reliability

What was attacked, how often, and what came of it. Every figure on this page was counted by `make campaign` on the code
whose digest stands below its table. A small share of the same campaign runs in every `make test`.

A violation is a trial that broke what the section says must hold.
"""

FAULTS_HEAD = """## The faults and how soon the motors are off

From the moment at which the cause began to the drivers' enable pin, the longest of a thousand moments on each board.
The [link reference](link.md#fault) has the remedies. Not in the table: `params` is found at start, with the motors off,
and the times of `tracking` and `unrest` are parameters.
"""

# The staged trial that shows a fault best. A person must move the joint first before `runaway` and `stalled` can show.
STAGED_AS = {
    "pot_low": "follower open",
    "pot_high": "follower shorted",
    "late_tick": "hang, interrupts on",
    "watchdog": "hang, interrupts off",
    "flood": "flood of 80 bytes a ms",
    "estop": "emergency stop pressed",
    "speed": "follower reads neighbour",
    "runaway": "motor reversed",
    "stalled": "joint blocked",
    "memory": "bit of the running set flips",
}


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


def write_faults(rows: Iterable[Row]) -> str:
    """The faults that the board reports: what raises each, and the longest time until the motors were off."""
    measured = {row.tried: row.worst.get("ms") for row in rows}
    enum = next(enum for enum in load(ROOT / "shared/link").enums if enum.name == "Fault")
    lines = ["| fault | raised when | staged as | ms on the Mega | ms on the Nano |", "|---|---|---|--:|--:|"]
    for value in enum.values:
        if staged := STAGED_AS.get(value.name):
            times = [measured.get(f"{board}: {staged}") for board in ("mega", "nano")]
            shown = " | ".join("" if time is None else f"{time:.4g}" for time in times)
            lines.append(f"| `{value.name}` | {value.cause} | {staged} | {shown} |")
    return "\n".join(lines) + "\n"


def write_page(results: list[tuple[Part, list[Row]]]) -> str:
    sections = [
        f"## {part.title}\n\n{' '.join(part.holds.split())}\n\n{write_table(rows)}\n"
        f"`python -m tools.campaign {part.name}`; digest `{identity(part)}`.\n"
        for part, rows in results
    ]
    faults = [row for part, rows in results if part.name == "faults" for row in rows]
    return "\n".join([HEAD, write_summary(results), FAULTS_HEAD, write_faults(faults), *sections])
