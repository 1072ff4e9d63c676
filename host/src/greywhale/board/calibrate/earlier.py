"""The earlier calibrations of a board as facts, for a terminal and a page: when, why, and what each one changed."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict

from greywhale.base.errors import UserError
from greywhale.board.calibrate.differences import differences
from greywhale.board.calibrate.history import kept


class KeptFacts(TypedDict):
    number: int
    when: str  # UTC, as 2026-05-31T09:30:00+00:00
    why: str  # found, calibrate, page, set, restore or back
    file: str  # all parameters of then; params restore takes it
    changed: list[str]  # against the one before, a joint each, in words; empty for the first
    values: dict[str, int]  # raw, by parameter; of the calibration alone
    problem: str | None  # the reason why the file cannot be used; then it has no values


def earlier(folder: Path) -> list[KeptFacts]:
    """The calibrations of a folder, the oldest first."""
    found: list[KeptFacts] = []
    before: dict[str, int] = {}
    for one in kept(folder):
        values: dict[str, int] = {}
        problem = None
        try:
            values = one.values()
        except UserError as error:
            problem = error.message
        changed = differences(before, values) if before and values else []
        before = values or before
        facts: KeptFacts = {
            "number": one.number,
            "when": one.when.isoformat(),
            "why": one.why,
            "file": str(one.path),
            "changed": changed,
            "values": values,
            "problem": problem,
        }
        found.append(facts)
    return found
