"""Limits with a reason: numbers that judge, each with its unit, why it has this size, and where that is from.

A room keeps its limits in one frozen dataclass, in groups where there are many, and is handed other values as an
argument. So an ablation is a loop over `dataclasses.replace`:

>>> @dataclass(frozen=True)
... class ReachLimits:
...     reach_rad: float = limit(1.0, "rad", "a hand goes this far without a pause", BY_JUDGEMENT)
>>> [(one.name, one.value, one.unit) for one in limits_in(ReachLimits())]
[('reach_rad', 1.0, 'rad')]
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, is_dataclass, replace
from types import ModuleType
from typing import Any, TypeVar

import numpy as np

from greywhale.base.types import Floats

# Where a value is from, if no measurement, paper or firmware gave it.
BY_JUDGEMENT = "by judgement"
BY_DEFINITION = "by definition"
BY_THE_FIRMWARE = "the firmware"
MEASURED_ON_ARMS = "measured: arms"
MEASURED_IN_TRIALS = "measured: trials"
MEASURED_IN_SEARCHES = "measured: tunings"

T = TypeVar("T")


@dataclass(frozen=True)
class Limit:
    """One number as people read it; `name` goes through the groups, with dots between."""

    name: str
    value: Any
    unit: str  # "" for a share or a factor
    reason: str
    origin: str


def limit(value: T, unit: str, reason: str, origin: str = BY_JUDGEMENT) -> T:
    """A field of a frozen dataclass of limits; its type is that of the value."""
    return field(default=value, metadata={"unit": unit, "reason": reason, "origin": origin})


def limits_in(limits: Any) -> Iterator[Limit]:
    """Every limit of a dataclass and of its groups; a group that another room made has a table of its own there."""
    for one in fields(limits):
        value = getattr(limits, one.name)
        if not is_dataclass(value):
            yield Limit(one.name, value, **one.metadata)
        elif _room_of(value) == _room_of(limits):
            yield from (replace(inner, name=f"{one.name}.{inner.name}") for inner in limits_in(value))


def names_in(limits: Any) -> tuple[str, ...]:
    """The names of the plain numbers of one group, in their order: compiled code has a struct of them."""
    return tuple(one.name for one in fields(limits) if isinstance(getattr(limits, one.name), (int, float)))


def numbers_in(limits: Any) -> Floats:
    """The plain numbers of one group, in their order, as compiled code takes them."""
    return np.array([getattr(limits, name) for name in names_in(limits)], dtype=np.float64)


def _room_of(limits: Any) -> str:
    """The module that made them, as far as the name limits in it."""
    return type(limits).__module__.partition(".limits")[0]


def changed(limits: Any, usual: Any) -> dict[str, Any]:
    """The values in which limits differ from the usual ones, by their dotted names."""
    found: dict[str, Any] = {}
    for one in fields(limits):
        here, there = getattr(limits, one.name), getattr(usual, one.name)
        if is_dataclass(here):
            found |= {f"{one.name}.{name}": value for name, value in changed(here, there).items()}
        elif here != there:
            found[one.name] = here
    return found


def markdown_list(limits: Any) -> str:
    """The limits as a list for the documentation; an origin stands there if it is more than judgement."""
    return "\n".join(map(_markdown, limits_in(limits)))


def markdown_list_of(room: ModuleType) -> str:
    """Such a list of all groups in a room's module of limits, each under the name that the code has for it."""
    groups = {name: value for name, value in vars(room).items() if is_dataclass(value) and not isinstance(value, type)}
    each = (replace(one, name=f"{name}.{one.name}") for name, value in groups.items() for one in limits_in(value))
    return "\n".join(map(_markdown, each))


def _markdown(one: Limit) -> str:
    return f"- `{one.name}` **{_shown(one)}**: {one.reason}{_origin(one)}"


def _origin(one: Limit) -> str:
    return "" if one.origin == BY_JUDGEMENT else f" ({one.origin})"


def _shown(one: Limit) -> str:
    values = one.value if isinstance(one.value, tuple) else (one.value,)
    return f"{', '.join(_text(value) for value in values)} {one.unit}".strip()


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(_text(inner) for inner in value)})"
    return f"{value:g}" if isinstance(value, float) else f"{value}"
