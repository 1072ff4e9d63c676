"""Limits with a reason: what a table shows of them, what differs, and that every room reads its own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

import greywhale
from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.base.limits import changed, limit, limits_in, markdown_list
from greywhale.commission.limits import COMMISSIONING_LIMITS
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.measure.limits import SWING_LIMITS
from greywhale.tune.limits import TUNING_LIMITS
from tests.support.limits import attributes_read, members_read
from tools import ROOT

PACKAGE = Path(greywhale.__file__).parent
NATIVE = ROOT / "host" / "native"

ROOMS = {
    "adapt": ADAPTATION_LIMITS,
    "commission": COMMISSIONING_LIMITS,
    "identify": IDENTIFICATION_LIMITS,
    "measure": SWING_LIMITS,
    "tune": TUNING_LIMITS,
}
# What reads them beside the room that keeps them.
READERS = {"measure": ("measure", "commission", "adapt", "tune")}
# The rooms whose limits compiled code reads too.
COMPILED = {"measure": NATIVE / "score", "tune": NATIVE / "score"}


@dataclass(frozen=True)
class Rest:
    still_rad: float = limit(0.02, "rad", "a hand trembles")


@dataclass(frozen=True)
class Own:
    rest: Rest = Rest()
    swings: Any = SWING_LIMITS
    gaps_m: tuple[float, ...] = limit((1.5, 2.0), "m", "two of them", "measured")


def test_a_list_has_a_line_for_each_limit_of_its_own() -> None:
    assert markdown_list(Own()).splitlines() == [
        "- `rest.still_rad` **0.02 rad**: a hand trembles",
        "- `gaps_m` **1.5, 2 m**: two of them (measured)",
    ]


def test_what_differs_is_named() -> None:
    other = replace(Own(), rest=Rest(0.03), swings=replace(SWING_LIMITS, unrest_growth=3.0))
    assert changed(other, Own()) == {"rest.still_rad": 0.03, "swings.unrest_growth": 3.0}
    assert changed(Own(), Own()) == {}


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_reads_all_its_limits(room: str) -> None:
    names = {one.name.rpartition(".")[2] for one in limits_in(ROOMS[room])}
    read = [attributes_read(PACKAGE / one) for one in READERS.get(room, (room,))]
    read += [members_read(COMPILED[room])] if room in COMPILED else []
    assert names - set().union(*read) == set()


@pytest.mark.parametrize("room", ROOMS)
def test_each_limit_has_a_reason_that_fits_into_a_table(room: str) -> None:
    for one in limits_in(ROOMS[room]):
        assert one.reason, one.name
        assert one.origin, one.name
        assert "|" not in f"{one.unit}{one.reason}{one.origin}"
        assert not one.reason.endswith(".")
