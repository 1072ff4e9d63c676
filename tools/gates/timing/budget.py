"""The committed bounds of an image: budget.toml, which `python -m tools.gates.timing --commit` writes."""

from __future__ import annotations

import tomllib
from pathlib import Path

from tools.gates.timing.image import Times

BUDGET = Path(__file__).with_name("budget.toml")
HEAD = """\
# Bounds in cycles that the firmware keeps to; the gates fail when one rises above its number. When it has to rise, or
# has fallen: `make firmware`, `python -m tools.gates.timing --commit`, and say in the commit why.
"""


def load(path: Path = BUDGET) -> dict[str, dict[str, int]]:
    """Chip and compiler -> what -> cycles."""
    return tomllib.loads(path.read_text())


def flat(times: Times) -> dict[str, int]:
    return {"tick": times.tick, **times.interrupts}


def text(bounds: dict[str, Times]) -> str:
    """The file for these bounds, by chip and compiler."""
    parts = [HEAD]
    for title, times in bounds.items():
        lines = [f'"{what}" = {cycles}' for what, cycles in flat(times).items()]
        parts.append("\n".join([f'["{title}"]', *lines, ""]))
    return "\n".join(parts)


def complaints(title: str, times: Times, committed: dict[str, dict[str, int]]) -> list[str]:
    """One sentence for each bound above its number."""
    return [
        f"the bound of {what} is {cycles} cycles, {cycles - allowed} more than tools/gates/timing/budget.toml allows."
        for what, cycles in flat(times).items()
        if cycles > (allowed := committed[title][what])
    ]
