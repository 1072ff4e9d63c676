"""Guesses the kind of a greywhale TOML table by its keys: the message on a file of the wrong kind names that kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from greywhale.base import sentences
from greywhale.base.errors import UserError


@dataclass(frozen=True)
class Marks:
    """Keys that only one kind has: one of them is enough. `and_key` must be there besides."""

    inside: tuple[str, ...] = ()  # in one of its [[joint]] and [[link]] tables
    inside_ends: tuple[str, ...] = ()  # endings of such keys
    top: tuple[str, ...] = ()
    tables: tuple[str, ...] = ()
    and_key: str | None = None


# An answers file names units in its keys.
_UNITS = ("_mm", "_g", "_deg", "_rpm", "_ma", "_a", "_ncm", "_nm", "_ohm", "_gcm2", "_v")
_GROUPS = tuple(f"{group}{number}" for group in ("joint", "leader", "follower") for number in range(4))
_OF_ARM = Marks(
    inside=("motor", "friction", "gear", "stops", "inertia", "centre"), top=("drive", "leader_pots", "follower_pots")
)


class Kind(Enum):
    """A kind of file: its name, who takes it, and its marks. A file is of the first kind that has marks in it."""

    CONTROLLER = "a controller file", "greywhale upload", Marks(inside=("kp", "kd", "ki", "ku", "sets"))
    MODEL = "a model", "greywhale tune", replace(_OF_ARM, and_key="identification")
    ARM = "an arm file", "greywhale identify --arm", _OF_ARM
    PARAMETERS = "a parameter file", "greywhale params restore", Marks(tables=_GROUPS)
    ANSWERS = "a file of answers", "greywhale arm new --answers", Marks(inside_ends=_UNITS, top=("supply_v",))

    def __init__(self, words: str, taker: str, marks: Marks) -> None:
        self.words, self.taker, self.marks = words, taker, marks


def kind_of(data: Mapping[str, Any]) -> Kind | None:
    """The kind of a parsed file; None where nothing tells it."""
    inside = {key for name in ("joint", "link") for table in _tables(data.get(name)) for key in table}
    return next((kind for kind in Kind if _is_marked(data, inside, kind.marks)), None)


def _is_marked(data: Mapping[str, Any], inside: set[str], marks: Marks) -> bool:
    found = (
        not inside.isdisjoint(marks.inside)
        or any(key.endswith(marks.inside_ends) for key in inside)
        or any(key in data for key in marks.top)
        or any(isinstance(data.get(key), Mapping) for key in marks.tables)
    )
    return found and (marks.and_key is None or marks.and_key in data)


def refuse_other_kind(data: Mapping[str, Any], name: str, *wanted: Kind) -> None:
    """Refuse a file that is clearly of another kind than those wanted; `name` stands for it."""
    kind = kind_of(data)
    if kind is not None and kind not in wanted:
        needed = " or ".join(one.words for one in wanted)
        raise UserError(f"{name}: {sentences.OTHER_KIND.format(kind=kind.words, needed=needed, taker=kind.taker)}")


def _tables(value: object) -> list[Mapping[str, Any]]:
    return [one for one in value if isinstance(one, Mapping)] if isinstance(value, list) else []
