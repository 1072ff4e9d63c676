"""Guesses the kind of a greywhale TOML table by its keys: the message on a file of the wrong kind names that kind."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import Any

from greywhale.base.errors import UserError


class Kind(Enum):
    """A kind of file, with its article, and who takes it."""

    ARM = "an arm file", "greywhale identify --arm"
    MODEL = "a model", "greywhale tune"
    CONTROLLER = "a controller file", "greywhale upload"
    PARAMETERS = "a parameter file", "greywhale params restore"
    ANSWERS = "a file of answers", "greywhale arm new --answers"

    def __init__(self, words: str, taker: str) -> None:
        self.words, self.taker = words, taker


# Keys that only one kind has, in one of its [[joint]] and [[link]] tables.
_OF_CONTROLLER = {"kp", "kd", "ki", "ku", "sets"}
_OF_ARM = {"motor", "friction", "gear", "stops", "inertia", "centre"}
# An answers file names units in its keys.
_UNITS = ("_mm", "_g", "_deg", "_rpm", "_ma", "_a", "_ncm", "_nm", "_ohm", "_gcm2", "_v")
_GROUPS = tuple(f"{group}{number}" for group in ("joint", "leader", "follower") for number in range(4))


def kind_of(data: Mapping[str, Any]) -> Kind | None:
    """The kind of a parsed file; None where nothing tells it."""
    inside = {key for name in ("joint", "link") for table in _tables(data.get(name)) for key in table}
    if inside & _OF_CONTROLLER:
        return Kind.CONTROLLER
    if inside & _OF_ARM or {"drive", "leader_pots", "follower_pots"} & data.keys():
        return Kind.MODEL if "identification" in data else Kind.ARM
    if any(isinstance(data.get(group), Mapping) for group in _GROUPS):
        return Kind.PARAMETERS
    if any(key.endswith(_UNITS) for key in inside) or "supply_v" in data:
        return Kind.ANSWERS
    return None


def refuse_other_kind(data: Mapping[str, Any], name: str, *wanted: Kind) -> None:
    """Refuse a file that is clearly of another kind than those wanted; `name` stands for it."""
    kind = kind_of(data)
    if kind is not None and kind not in wanted:
        needed = " or ".join(one.words for one in wanted)
        raise UserError(f"{name}: this is {kind.words}, but {needed} is needed here ({kind.taker} takes {kind.words}).")


def _tables(value: object) -> list[Mapping[str, Any]]:
    return [one for one in value if isinstance(one, Mapping)] if isinstance(value, list) else []
