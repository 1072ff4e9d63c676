"""The page that publishes the attacks: docs/reliability.md."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

from tools import ROOT
from tools.attack.part import STAYED_ON, Row, add_up
from tools.attack.run import Result, digest
from tools.generate.link.declaration import load

HEAD = """<!-- Written by `make attack`; change the attacks, not this page. -->

# Reliability

{result} `make attack` counted every figure, on the code whose digest stands below
its table; `make test` runs a small share.

A violation is a trial that broke what its section says must hold. `a/b` is a on the Mega and b on the Nano; one number
is that of either; `min` are the minutes of all workers. Where motors run, `seen` counts what turned them off (`none`:
no fault); in all other trials they stayed on.

**Known and left open**: a potentiometer that lies slowly or below its breakaway voltage, and a leader's reading that
glides like a hand ([why](firmware.md#how-a-follower-must-move), [what they cost](#slow-lies-and-two-faults-at-once)); a
gain that falls by less than a quarter, under `adapt`; a Nano with an [old bootloader](firmware.md#bootloaders) after a
hang with interrupts off: silent, motors off; a flood of connections to the dashboard, for which a new page waits some
seconds.
"""

FAULTS_HEAD = """## The faults and how soon the motors are off

From the cause to the drivers' enable pin, the longest of all moments, to 0.25 ms ([causes and
remedies](link.md#fault)). Without a time: other faults may end the trial as well, see its row below. Not listed:
`params` is found at start, motors off; the times of `tracking`, `stalled` and `unrest` are parameters; a hang with
interrupts on turns the motors off as `late_tick`.
"""

COLUMNS = ("tried", "trials", "violations", "worst", "seen")
MOSTLY = 0.95  # a flipped bit may also be that of another fault's parameter

# The injected fault that shows a fault best. A person must move the joint before `runaway` can show.
INJECTED_AS = {
    "pot_low": "follower open",
    "pot_high": "follower shorted",
    "watchdog": "hang, interrupts off",
    "flood": "flood of 80 bytes a ms",
    "estop": "emergency stop pressed",
    "speed": "follower reads neighbour",
    "runaway": "motor reversed",
    "memory": "bit of the running set flips",
    "leader_jump": "leader jumps 1 rad",
}


def write_table(rows: Iterable[Row]) -> str:
    """A Markdown table. Rows that differ only in their board are one; what all rows share stands above the table."""
    lines = [[tried, *(_on_both(*cells) for cells in zip(*found, strict=True))] for tried, found in _by_name(rows)]
    same = {n for n in range(1, len(COLUMNS)) if len(lines) > 1 and len({line[n] for line in lines}) == 1}
    above = ", ".join(f"{lines[0][n]} {COLUMNS[n]}" for n in sorted(same) if lines[0][n])
    shown = [n for n in range(len(COLUMNS)) if n not in same]
    head, cells = [COLUMNS[n] for n in shown], [[line[n] for n in shown] for line in lines]
    marks = ["--:" if n in (1, 2) else "---" for n in shown]
    if pairs := _side_by_side(head, cells):
        head, cells = pairs
        marks = marks[:1] + 2 * marks[1:]
    table = [f"| {' | '.join(head)} |", f"|{'|'.join(marks)}|", *(f"| {' | '.join(line)} |" for line in cells)]
    return (f"In each row: {above}.\n\n" if above else "") + "\n".join(table) + "\n"


def _side_by_side(head: list[str], cells: list[list[str]]) -> tuple[list[str], list[list[str]]] | None:
    """Rows in pairs, where each thing was tried in the same two cases, which its name ends with; None elsewhere."""
    found: dict[str, dict[str, list[str]]] = {}
    for tried, *others in cells:
        thing, _, case = tried.rpartition(", ")
        found.setdefault(thing, {})[case] = others
    cases = list(next(iter(found.values()), {}))
    if "" in found or len(cases) != 2 or any(list(one) != cases for one in found.values()):
        return None
    return (
        [head[0], *(f"{column}, {case}" for case in cases for column in head[1:])],
        [[thing, *one[cases[0]], *one[cases[1]]] for thing, one in found.items()],
    )


def _by_name(rows: Iterable[Row]) -> list[tuple[str, list[list[str]]]]:
    """The cells of each thing tried: one row, or those of the Mega and of the Nano."""
    found: dict[str, dict[str, list[str]]] = {}
    for row in _on_and_off(rows):
        worst = ", ".join(f"{value:.4g} {name}" for name, value in row.worst.items())
        counts = {name: count for name, count in row.counts.items() if name != STAYED_ON}
        seen = ", ".join(f"{name} {count:,}" for name, count in sorted(counts.items(), key=lambda one: -one[1]))
        violations = f"**{row.violations:,}**" if row.violations else "0"
        board, name = re.fullmatch(r"(?i:(mega|nano): )?(.*)", row.tried).groups(default="")  # type: ignore[union-attr]
        found.setdefault(name, {})[board] = [f"{row.trials:,}", violations, worst, seen]
    return [
        (name if len(boards) == 2 or "" in boards else f"{next(iter(boards))}: {name}", list(boards.values()))
        for name, boards in found.items()
    ]


def _on_and_off(rows: Iterable[Row]) -> list[Row]:
    """One row for all rhythms of a fault that comes and goes ("2 of 3 ms"), and every other row as it is."""
    rows = list(rows)
    parted = [re.fullmatch(r"(.* )(\d+ of \d+) ms", row.tried) for row in rows]
    rhythms: dict[str, list[str]] = {}
    for one in filter(None, parted):
        rhythms.setdefault(one[1], []).append(one[2])
    names = [
        f"{one[1]}{', '.join(rhythms[one[1]])} ms" if one else row.tried for one, row in zip(parted, rows, strict=True)
    ]
    return add_up(replace(row, tried=name) for row, name in zip(rows, names, strict=True))


def _on_both(mega: str, nano: str | None = None) -> str:
    """A cell of both boards: one text, with both numbers where they differ, or both texts where words differ."""
    if nano is None or mega == nano:
        return mega
    words, others = (re.split(r"(\*{0,2}[\d.,]*\d\*{0,2})", text) for text in (mega, nano))
    if words[::2] != others[::2]:
        return f"{mega} / {nano}"
    return "".join(one if one == two else f"{one}/{two}" for one, two in zip(words, others, strict=True))


def write_result(results: Sequence[Result]) -> str:
    """One sentence: how many trials there were, and where some broke a promise."""
    trials = sum(row.trials for one in results for row in one.rows)
    broken = {one.part.title: sum(row.violations for row in one.rows) for one in results}
    where = ", ".join(f'{count:,} in "{title}"' for title, count in broken.items() if count)
    return f"**Of {trials:,} trials, these broke a promise: {where or 'none'}.**"


def write_summary(results: Iterable[Result]) -> str:
    """One line for each part."""
    lines = ["| | trials | violations | min |", "|---|--:|--:|--:|"]
    for one in results:
        trials, violations = sum(row.trials for row in one.rows), sum(row.violations for row in one.rows)
        anchor = one.part.title.lower().replace(" ", "-").replace(",", "")
        lines.append(f"| [{one.part.title}](#{anchor}) | {trials:,} | {violations:,} | {one.seconds / 60:.0f} |")
    return "\n".join(lines) + "\n"


def write_faults(rows: Iterable[Row]) -> str:
    """The faults that the board reports: how each was injected, and the longest time until the motors were off."""
    seen = {row.tried: row for row in rows}
    enum = next(enum for enum in load(ROOT / "shared/link").enums if enum.name == "Fault")
    lines = ["| fault | injected as | ms |", "|---|---|--:|"]
    for value in enum.values:
        if injected := INJECTED_AS.get(value.name):
            times = [_time(seen.get(f"{board}: {injected}"), value.name) for board in ("mega", "nano")]
            shown = ("" if time is None else f"{time:.4g}" for time in times)
            lines.append(f"| `{value.name}` | {injected} | {_on_both(*shown)} |")
    return "\n".join(lines) + "\n"


def _time(row: Row | None, fault: str) -> float | None:
    """The longest time until the motors were off, where it was this fault that turned them off."""
    if row is None:
        return None
    off = row.trials - row.counts.get(STAYED_ON, 0)
    return row.worst.get("ms") if row.counts.get(fault, 0) >= MOSTLY * off else None


def write_page(results: Sequence[Result]) -> str:
    sections = [
        f"## {one.part.title}\n\n{' '.join(one.part.holds.split())}\n\n{write_table(one.rows)}\n"
        f"`python -m tools.attack {one.part.name}`; digest `{digest(one.part)}`.\n"
        for one in results
    ]
    faults = [row for one in results if one.part.name == "faults" for row in one.rows]
    head = HEAD.format(result=write_result(results))
    return "\n".join([head, write_summary(results), FAULTS_HEAD, write_faults(faults), *sections])
