"""Numbers as they stand in the report: one, or the median of several with their range."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

NONE = "–"
LONGEST = 24  # letters of a range
Number = float | None


def one(value: Number, form: str = ".4f") -> str:
    """A number, or a dash where there is none."""
    return NONE if value is None else _shown(value, form)


def _shown(value: float, form: str) -> str:
    """Without the sign of what is rounded to nothing."""
    text = f"{value:{form}}"
    return text.removeprefix("-") if float(text) == 0.0 else text


def several(values: Sequence[Number], form: str = ".4f") -> str:
    """Median (lowest to highest); a single one stands alone, and so do those that look the same."""
    known = [value for value in values if value is not None]
    if not known:
        return NONE
    low, high, middle = (_shown(value, form) for value in (min(known), max(known), float(np.median(known))))
    missing = f", {len(values) - len(known)} without" if len(known) < len(values) else ""
    return f"{middle}{missing and ' (' + missing[2:] + ')'}" if low == high else f"{middle} ({low} to {high}{missing})"


def lower(before: float, after: float) -> float:
    """By how many per cent it fell."""
    return 100.0 * (1.0 - after / before)


def change(percents: float, form: str = ".1f") -> str:
    """A change with its sign; what is too small to be seen says so, and has none."""
    text = f"{percents:+{form}}"
    if float(text) != 0.0:
        return f"{text} %"
    return "0 %" if percents == 0.0 else f"< {text[1:-1]}1 %"


def percent(before: float, after: float) -> str:
    """The same, as words."""
    change = lower(before, after)
    return f"{change:.1f} % lower" if change >= 0.0 else f"{-change:.1f} % higher"


def keep_ranges(text: str) -> str:
    """A line may break before a range such as (0.1 to 0.2), not inside of it."""
    return re.sub(rf"\([^()]{{1,{LONGEST}}}\)", lambda found: found.group().replace(" ", "\xa0"), text)
