"""Equal bytes at equal cycles give equal behaviour, to the cycle, however the run is cut up."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from greywhale._native import Board
from greywhale_sim.programs import load_elf
from tests.simulated_board.avr import BUSY, Compile

PERIOD = 80_000  # inputs change and bytes come every 5 ms


class Result(NamedTuple):
    trace_hash: int
    cycle: int
    sent: bytes
    memory: bytes
    eeprom: bytes


class Session:
    """One board with inputs that depend on time only; advance() may cut the time anyhow."""

    def __init__(self, path: Path) -> None:
        self.board = Board("atmega2560")
        load_elf(self.board, path)
        self.board.power_on(3)
        self.board.add_duty_output(3, "A")
        self.next_input = 0
        self.sent = b""

    def advance(self, until: int, chunk: int) -> None:
        """Runs to the cycle in chunks, and applies the inputs that are due on the way at their own cycles."""
        at = self.board.cycle
        while at < until:
            if at >= self.next_input:
                step = self.next_input // PERIOD
                self.board.set_millivolts(np.array([(step * 311 + 97 * i) % 5000 for i in range(8)], dtype=float))
                self.board.uart_send(bytes([step & 255, 7]))
                self.next_input += PERIOD
            at = min(at + chunk, until, self.next_input)
            self.board.run_until(at)
            self.board.outputs()
            self.sent += self.board.uart_receive()

    def result(self) -> Result:
        board = self.board
        return Result(board.trace_hash, board.cycle, self.sent, board.peek(0x100, 8192), board.eeprom())


@pytest.fixture(scope="module")
def busy(compile_avr: Compile) -> Path:
    return compile_avr(BUSY, "atmega2560")


END = 3_200_000


@pytest.fixture(scope="module")
def reference(busy: Path) -> Result:
    session = Session(busy)
    session.advance(END, END)
    assert len(session.sent) > 50
    assert session.board.stats().adc_conversions > 300
    assert session.board.stats().eeprom_writes > 50
    return session.result()


@pytest.mark.parametrize("chunk", [END, 4_000, 13])
def test_neither_repeating_nor_cutting_the_run_changes_anything(busy: Path, reference: Result, chunk: int) -> None:
    session = Session(busy)
    session.advance(END, chunk)
    assert session.result() == reference


def test_two_boards_side_by_side_do_not_disturb_each_other(busy: Path, reference: Result) -> None:
    first, second = Session(busy), Session(busy)
    for until in range(9_000, END + 9_000, 9_000):
        first.advance(min(until, END), 4_000)
        second.advance(min(until + 5_000, END), 1_234)
    assert first.result() == reference
    assert second.result() == reference


def test_the_trace_hash_notices_one_count_and_one_byte(busy: Path, reference: Result) -> None:
    for change in ("voltage", "byte"):
        session = Session(busy)
        session.advance(PERIOD // 2, 4_000)
        if change == "voltage":
            session.board.set_millivolts(np.array([5.0] + [97.0 * i for i in range(1, 8)]))
        else:
            session.board.uart_send(b"\x01")
        session.advance(END, 4_000)
        assert session.board.trace_hash != reference.trace_hash
