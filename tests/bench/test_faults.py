"""The list of faults: each can be injected and mended, and command line and page show the same list."""

from __future__ import annotations

import re

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.cli.entry import run
from greywhale_sim import faults
from greywhale_sim.bench import Bench
from greywhale_sim.board_supply import FULL_MV, SUNK_MV, SUNK_SLICES, SharedSupply
from greywhale_sim.faults import BY_NAME, FAULTS, WHERE, Fault
from greywhale_sim.pins_seen import PinsSeen
from tests.bench.conftest import FakeBoard


def wired(bench: Bench) -> tuple[object, ...]:
    return (
        bench.pot_faults.any,
        bench.floating,
        *bench.motor_gains,
        *bench.motor_wires,
        bench.supply_v,
        bench.shared_supply,
    )


@pytest.mark.parametrize("fault", FAULTS, ids=lambda one: one.name)
def test_each_is_injected_at_every_place_and_mended(bench: Bench, fault: Fault) -> None:
    before = wired(bench)
    for place in WHERE[fault.on]:
        faults.inject(bench, f"{fault.name}:{place}" if place else fault.name)
        wires = [*bench.leader_pots.wirings.values(), *bench.follower_pots.wirings.values()]  # type: ignore[attr-defined]
        assert wired(bench) != before or any(wire != wires[0] for wire in wires) or len(wires) == 1
        faults.mend(bench)
        assert wired(bench) == before


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("pot-open:leader7", '"leader7" is no place for pot-open'),
        ("no-supply:1", '"1" is no place for no-supply; say no-supply alone'),
        ("pot-eaten", '"pot-eaten" is no mistake; there are: pot-swapped, '),
    ],
)
def test_what_is_not_understood_changes_nothing(bench: Bench, words: str, says: str) -> None:
    before = wired(bench)
    with pytest.raises(UserError, match=re.escape(says)):
        faults.inject(bench, words)
    assert wired(bench) == before


def test_the_command_line_lists_them_all(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["sim", "--mistake", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [re.split("[: ]", line)[0] for line in lines] == list(BY_NAME)


def test_a_shared_supply_sinks_while_a_motor_draws_and_comes_back() -> None:
    board = FakeBoard()
    supply = SharedSupply(board)
    supply.look(np.zeros(4))
    assert board.events == []
    supply.look(np.array([0.0, -1.5, 0.0, 0.0]))
    assert board.events == [f"supply {SUNK_MV}"]
    for _ in range(SUNK_SLICES):
        supply.look(np.zeros(4))
    assert board.events == [f"supply {SUNK_MV}", f"supply {FULL_MV}"]


def test_the_pins_are_seen_only_while_the_drivers_are_on() -> None:
    seen = PinsSeen()
    seen.look(0, False, [0.9] * 4)
    seen.look(100, True, [0.1, 0.0, 0.0, 0.2])
    seen.look(150, True, [0.3, 0.0, 0.0, 0.1])
    seen.look(400, False, [0.8] * 4)
    seen.look(1000, True, [0.0] * 4)
    assert seen.duties == [0.3, 0.0, 0.0, 0.2]
    assert seen.longest(1100) == 300
    assert seen.longest(1500) == 500
