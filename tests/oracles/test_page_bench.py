"""The bench inside a page is that of Python, by another compiler: the same bytes and cycles, voltages and angles.

Both run the same image on the same board, with the same seeds, and are asked for the same things at the same times.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from greywhale._native import Board
from greywhale.files.arm import default_arm
from greywhale.files.trajectory import Trajectory
from greywhale.protocol import schema
from greywhale_sim import faults
from greywhale_sim.assemble import BUILDS, BenchOptions, build_bench
from greywhale_sim.bench import SLICE_S, SLICES_PER_S
from greywhale_sim.leader_player import LeaderPlayer
from greywhale_sim.wiring import BOARDS
from tests.oracles.page_bench import PageBench
from tests.oracles.second_simulator import request
from tools.site.bench_data import fault_calls

HASH_BITS_LEFT_OUT = 11  # a page's number holds the others
BOOT_S = {"mega": 1.2, "nano": 2.4}  # their bootloaders wait for a host at first
PIECE_SLICES = 40  # 10 ms, of which a page's buffer holds the bytes


class Pair:
    """Both benches, at the same slice."""

    def __init__(self, board: str) -> None:
        wiring = BOARDS[board]
        home = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 4)))
        self.page = PageBench(default_arm(), wiring, BUILDS / wiring.environment / "firmware.hex")
        self.bench = build_bench(BenchOptions(board=board), leader=LeaderPlayer(home, SLICE_S))
        assert isinstance(self.bench.board, Board)
        self.board = self.bench.board
        self.page.call("power", 1)
        self.said = 0
        self.live(BOOT_S[board])

    def both(self, name: str, *given: Any) -> None:
        """Call one method of both; a kind of fault is a number to the page."""
        getattr(self.bench, name)(*given)
        self.page.call(name, *(float(getattr(one, "value", one)) for one in given))

    def lead(self, *angles: float) -> None:
        self.page.call("put", angles)
        self.page.call("lead")
        self.bench.leader.lead(np.array(angles))

    def send(self, data: bytes) -> None:
        self.page.send(data)
        self.board.uart_send(data)

    def start(self) -> None:
        self.send(request(schema.ClearFaultRequest, 1))
        self.live(0.01)
        self.send(request(schema.TelemetryRequest, 2, struct.pack("<H", 1)))
        self.send(request(schema.EnableRequest, 3, struct.pack("<H", 0)))

    def live(self, seconds: float) -> None:
        """Let both live, and compare all that they show then."""
        for _ in range(round(seconds * SLICES_PER_S / PIECE_SLICES)):
            self.bench.run_slices(PIECE_SLICES)
            said = self.board.uart_receive()
            assert bytes.fromhex(self.page.call("run", PIECE_SLICES)) == said
            self.said += len(said)
        ours = [*self.bench.leader.angles, *self.bench.angles, *self.bench.voltages]
        assert self.page.call("look") == ours
        assert self.page.call("trace_hash") == self.board.trace_hash >> HASH_BITS_LEFT_OUT
        assert self.page.call("cycle") == self.board.cycle


@pytest.fixture
def pair() -> Iterator[Callable[[str], Pair]]:
    made: list[Pair] = []

    def make(board: str = "mega") -> Pair:
        made.append(Pair(board))
        return made[-1]

    yield make
    for one in made:
        one.page.close()


@pytest.mark.parametrize("board", BOARDS)
def test_the_arm_follows_is_loaded_and_is_brought_back(pair: Callable[[str], Pair], board: str) -> None:
    two = pair(board)
    two.start()
    for angles in ([0.4, 0.3, -0.5, 0.2], [-0.9, -0.2, 0.6, -0.4]):
        two.lead(*angles)
        two.live(1.0)
    two.both("load_tip", 0.2)
    two.both("scale_noise", 3.0)
    two.live(0.3)
    assert np.abs(two.bench.voltages).max() > 0.5
    assert two.said > 20_000, "samples came"
    two.send(request(schema.StopRequest, 3))
    two.lead(3.0, 0.0, 0.0, 0.0)  # no hand moves a follower beyond its stops
    two.live(2.0)
    assert two.bench.angles[0] == default_arm().joint[0].stops.max


@pytest.mark.parametrize("name", [one.name for one in faults.FAULTS])
def test_a_mistake_is_the_same_mistake(pair: Callable[..., Pair], name: str) -> None:
    two = pair()
    places = faults.WHERE[faults.BY_NAME[name].on]
    for place in dict.fromkeys((places[0], places[-1])):
        faults.inject(two.bench, f"{name}:{place}" if place else name)
        for method, *given in fault_calls(name, place):
            two.page.call(method, *given)
        two.start()
        two.lead(0.3, 0.2, -0.4, 0.3)
        two.live(0.6)
        two.both("mend")
        two.lead(0.0, 0.1, 0.0, 0.0)
        two.live(0.2)


def test_what_the_board_stores_is_the_same_and_outlives_a_cut_in_the_middle(pair: Callable[..., Pair]) -> None:
    two = pair()
    two.send(request(schema.ParamSaveRequest, 4))
    two.live(0.3)  # a save takes longer
    two.page.call("power", 0)
    two.board.power_off(1)
    for again in (False, True):
        stored = two.board.eeprom()
        assert bytes.fromhex(two.page.call("read_eeprom")) == stored
        assert stored != b"\xff" * len(stored)
        if not again:
            two.page.call("power", 1)
            two.board.power_on(1)
            two.live(BOOT_S["mega"])
