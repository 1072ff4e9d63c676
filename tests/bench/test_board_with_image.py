"""A board with an image never keeps whoever measures it waiting: a wrong image is told in a sentence."""

from __future__ import annotations

from typing import Any

import pytest

from greywhale_sim.board_with_image import CYCLES_PER_TICK, BoardWithImage


class Halted:
    """In place of a board, in which nothing moves on; `state` is what it says of that."""

    pc = cycle = 0

    def __init__(self, state: int, cycles: int) -> None:
        self.state, self.cycles = state, cycles

    def run_until(self, cycle: int) -> int:
        self.cycle += self.cycles
        return self.state

    def peek(self, address: int, count: int) -> bytes:
        return bytes(count)


@pytest.mark.parametrize(("state", "cycles"), [(2, 0), (1, 0), (0, CYCLES_PER_TICK)], ids=["crashed", "ended", "lost"])
def test_an_image_that_never_comes_there_is_told(state: int, cycles: int) -> None:
    bench = BoardWithImage("nano")
    halted: Any = Halted(state, cycles)
    bench.board = halted
    with pytest.raises(
        RuntimeError, match=r"did not come to address 0x64 within 60 ms of the board's time: it crashed,"
    ):
        bench.run_to(100)
    with pytest.raises(RuntimeError, match=r"did not come to address \S+ within 60 ms"):
        bench.tick_cycles()


def test_it_comes_to_its_tick() -> None:
    bench = BoardWithImage("nano")
    assert bench.next_entry() == bench.board.cycle
    whole, work = bench.tick_cycles()
    assert 0 < work <= whole < CYCLES_PER_TICK
