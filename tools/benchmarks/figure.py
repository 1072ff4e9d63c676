"""One measured number, beside what the project wants to reach."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """`reach` is the aim in words, `holds` whether it is reached (None: the number is only for information)."""

    name: str
    value: float
    unit: str
    reach: str = ""
    holds: bool | None = None


def at_most(name: str, value: float, unit: str, limit: float) -> Figure:
    return Figure(name, value, unit, f"<= {limit:,g}", value <= limit)


def at_least(name: str, value: float, unit: str, limit: float) -> Figure:
    return Figure(name, value, unit, f">= {limit:,g}", value >= limit)
