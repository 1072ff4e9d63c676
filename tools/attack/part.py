"""A part of the attacks: one kind of attack, cut into pieces that any worker can do in any order."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

Piece = dict[str, Any]  # JSON; says with its seed all that a piece depends on
STAYED_ON = "motors stayed on"  # the trials of a row that nothing else it counts has ended


@dataclass(frozen=True)
class Row:
    """The outcome of one kind of trial. Rows of the same name are added up over all pieces of a part.

    `violations` are the trials that broke what the part says must hold. `counts` add up, such as which fault was
    reported; of `worst` the greatest counts, such as milliseconds.
    """

    tried: str
    trials: int
    violations: int
    counts: dict[str, int] = field(default_factory=dict)
    worst: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Part:
    """`pieces` gives the work for a share (1: full size) of the trials, `run` does one piece.

    `depends` names the files and folders of the project that the result is about: when one of them changes, what was
    measured before no longer counts.
    """

    name: str
    title: str
    holds: str  # a paragraph: what is tried, and what must hold
    depends: tuple[str, ...]
    pieces: Callable[[float], list[Piece]]
    run: Callable[[Piece], list[Row]]


def add_up(rows: Iterable[Row]) -> list[Row]:
    """One row for each name, in the order of their first appearance."""
    found: dict[str, Row] = {}
    for row in rows:
        have = found.get(row.tried, Row(row.tried, 0, 0))
        found[row.tried] = Row(
            row.tried,
            have.trials + row.trials,
            have.violations + row.violations,
            {key: have.counts.get(key, 0) + row.counts.get(key, 0) for key in have.counts | row.counts},
            {key: max(side[key] for side in (have.worst, row.worst) if key in side) for key in have.worst | row.worst},
        )
    return list(found.values())


def split(total: int, share: float, size: int, **fixed: Any) -> list[Piece]:
    """Pieces of at most `size` trials, each with a seed of its own, for a share of `total` trials (at least one)."""
    trials = max(1, round(total * share))
    starts = range(0, trials, size)
    return [{**fixed, "seed": number, "trials": min(size, trials - start)} for number, start in enumerate(starts)]
