"""The list of faults: each can be injected and mended, and command line and page show the same list."""

from __future__ import annotations

import re

import pytest

from greywhale.base.errors import UserError
from greywhale.cli.entry import run
from greywhale_sim import faults
from greywhale_sim.bench import SLICE_CYCLES, Bench
from greywhale_sim.faults import BY_NAME, FAULTS, WHERE, Fault
from tests.bench.conftest import FakeBoard


def wired(bench: Bench) -> tuple[object, ...]:
    return (
        bench.has_pot_faults,
        *(bench.pot_wiring(pot) for pot in range(8)),
        bench.floating,
        *bench.motor_gains,
        *bench.motor_drivers,
        bench.supply_v,
        bench.shares_supply,
    )


@pytest.mark.parametrize("fault", FAULTS, ids=lambda one: one.name)
def test_each_is_injected_at_every_place_and_mended(bench: Bench, fault: Fault) -> None:
    before = wired(bench)
    for place in WHERE[fault.on]:
        faults.inject(bench, f"{fault.name}:{place}" if place else fault.name)
        assert wired(bench) != before
        bench.mend()
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


ENABLE, DUTY = 0, slice(1, 5)
SUNK_SLICES = 120  # 30 ms


def test_a_shared_supply_sinks_while_a_motor_draws_and_comes_back(bench: Bench, board: FakeBoard) -> None:
    bench.share_supply()
    board.pins[ENABLE] = 1
    bench.run_slices(1)
    assert board.events == []
    board.pins[DUTY] = [0.0, 0.2, 0.0, 0.0]
    bench.run_slices(1)
    assert board.events == ["supply 2400"]
    board.pins[:] = 0
    bench.run_slices(SUNK_SLICES)
    assert board.events == ["supply 2400", "supply 5000"]


def test_the_pins_are_seen_only_while_the_drivers_are_on(bench: Bench, board: FakeBoard) -> None:
    """A driver without its enable pin drives nothing, whatever its duty is."""
    for enable, duties, slices in (
        (0, [0.9] * 4, 4),
        (1, [0.1, 0.0, 0.0, 0.2], 5),
        (1, [0.3, 0.0, 0.0, 0.1], 10),
        (0, [0.8] * 4, 20),
        (1, [0.0] * 4, 2),
    ):
        board.pins[ENABLE], board.pins[DUTY] = enable, duties
        bench.run_slices(slices)
    duties, longest = bench.take_pins_seen(board.cycle)
    assert duties == [0.3, 0.0, 0.0, 0.2]
    assert longest == pytest.approx(15 * SLICE_CYCLES, abs=1)
    bench.run_slices(4)
    assert bench.take_pins_seen(board.cycle) == ([0.0] * 4, 0), "nothing was asked of them since"
