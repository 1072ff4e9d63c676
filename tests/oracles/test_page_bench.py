"""The bench inside a page is that of greywhale_sim: the same pins give the same voltages and angles, slice by slice.

The firmware inside the page drives its bench, and what it does with its pins is replayed to greywhale_sim's. Both have
the same seeds, so every number is the same to the bit.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

import numpy as np
import pytest

from greywhale.arm import Arm, Potentiometers
from greywhale.files.arm import default_arm
from greywhale.files.trajectory import Trajectory
from greywhale.protocol import schema
from greywhale_sim import faults
from greywhale_sim.bench import SLICE_S, Bench
from greywhale_sim.board_supply import FULL_MV
from greywhale_sim.leader_player import LeaderPlayer
from greywhale_sim.wiring import MEGA
from tests.bench.conftest import FakeBoard
from tests.oracles.page_bench import PageBench
from tests.oracles.second_simulator import request
from tools.site.bench_data import fault_calls

SEED = 1
PINS, POWERED = slice(20, 29), 29  # of what the module shows


class ReplayedBoard(FakeBoard):
    """A board to greywhale_sim's bench: its pins are those of the page, and nothing runs on it."""

    supply_mv = FULL_MV

    def set_supply(self, millivolts: int, seed: int = 1) -> None:
        self.supply_mv = millivolts


class Pair:
    """Both benches, at the same slice."""

    def __init__(self, page: PageBench) -> None:
        arm = default_arm()
        home = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 4)))
        self.page, self.board = page, ReplayedBoard()
        self.bench = Bench(
            self.board,
            MEGA,
            Arm(arm, seed=SEED),
            LeaderPlayer(home, SLICE_S),
            Potentiometers(arm.leader_pots, SEED),
            Potentiometers(arm.follower_pots, SEED + 1),
            arm.drive.supply,
        )
        self.lead([0.0] * 4)
        page.call("power", 1)

    def lead(self, angles: list[float]) -> None:
        self.page.calls([["put", angles], ["lead"]])
        self.bench.leader.lead(np.array(angles))

    def fault(self, name: str, place: str) -> None:
        self.page.calls(fault_calls(name, place))
        faults.inject(self.bench, f"{name}:{place}" if place else name)

    def mend(self) -> None:
        self.page.call("mend")
        faults.mend(self.bench)

    def send(self, data: bytes) -> None:
        self.page.call("send", data.hex())

    def live(self, slices: int) -> None:
        """Let both live, and compare them after each slice."""
        before, after = self.page.calls([["look"], ["trace", slices]])
        page = np.array(after)
        ours = np.empty_like(page)
        for row, pins in zip(ours, [before[PINS], *page[:-1, PINS]], strict=True):
            self.board.pins[: len(pins)] = pins
            self.bench.run_slices(1)
            row[:20] = *self.board.millivolts[-1], *self.bench.voltages, *self.bench.leader.angles, *self.bench.angles
            row[POWERED] = self.board.supply_mv == FULL_MV
        ours[:, PINS] = page[:, PINS]
        np.testing.assert_array_equal(page, ours)


@pytest.fixture
def pair() -> Iterator[Pair]:
    with PageBench(default_arm(), SEED) as page:
        yield Pair(page)


def start(pair: Pair) -> None:
    pair.send(request(schema.ClearFaultRequest, 1))
    pair.live(40)
    pair.send(request(schema.EnableRequest, 2, struct.pack("<H", 0)))


def test_the_arm_follows_is_loaded_and_is_brought_back(pair: Pair) -> None:
    pair.live(400)
    start(pair)
    for angles in ([0.4, 0.3, -0.5, 0.2], [-0.9, -0.2, 0.6, -0.4]):
        pair.lead(angles)
        pair.live(4000)
    pair.page.call("load_tip", 0.2)
    pair.bench.load_tip(0.2)
    pair.live(1000)
    assert np.abs(pair.bench.voltages).max() > 0.5
    pair.send(request(schema.StopRequest, 3))
    pair.lead([3.0, 0.0, 0.0, 0.0])  # no hand moves a follower beyond its stops
    pair.live(8000)
    assert pair.bench.angles[0] == default_arm().joint[0].stops.max
    assert pair.bench.leader.hold is not None


@pytest.mark.parametrize("name", [one.name for one in faults.FAULTS])
def test_a_mistake_is_the_same_mistake(pair: Pair, name: str) -> None:
    places = faults.WHERE[faults.BY_NAME[name].on]
    pair.live(300)
    for place in dict.fromkeys((places[0], places[-1])):
        pair.fault(name, place)
        start(pair)
        pair.lead([0.3, 0.2, -0.4, 0.3])
        pair.live(1500)
        pair.mend()
        pair.lead([0.0, 0.1, 0.0, 0.0])
        pair.live(400)
