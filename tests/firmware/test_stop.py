"""A stop on the real images while the line is abused: in floods of any kind and rate, and with damaged bytes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from greywhale.board.device import stop_message
from greywhale.board.limits import PATIENCE
from greywhale.protocol import frames, schema
from greywhale_sim.board_with_image import CYCLES_PER_TICK, BoardWithImage
from greywhale_sim.line import Noise
from tests.firmware.conftest import enable

OFF_MS = 30.0
PIECE_MS = 0.1  # the flood is poured in so small pieces
LONGEST_FRAME = 54
STATUS = frames.encode_frame(schema.StatusRequest.TYPE, 9, b"")

Flood = Callable[[np.random.Generator, int], bytes]


def garbage(random: np.random.Generator, count: int) -> bytes:
    return random.bytes(count)


def requests(_: np.random.Generator, count: int) -> bytes:
    return (STATUS * (count // len(STATUS) + 1))[:count]


def unfinished(random: np.random.Generator, count: int) -> bytes:
    """Frames that never end: no zero among the bytes."""
    return bytes(random.integers(1, 256, count, dtype=np.uint8))


def too_long(random: np.random.Generator, count: int) -> bytes:
    """Frames of the greatest length, cut off by a zero before their end."""
    frame = bytes(random.integers(LONGEST_FRAME, 256, LONGEST_FRAME - 1, dtype=np.uint8)) + b"\0"
    return (frame * (count // len(frame) + 1))[:count]


def zeros(_: np.random.Generator, count: int) -> bytes:
    return bytes(count)


class Pour:
    """A flood that goes on piece by piece, at so many bytes a millisecond, whatever else is sent in between."""

    def __init__(self, bench: BoardWithImage, kind: Flood, rate: int) -> None:
        self.bench, self.rate = bench, rate
        self._bytes = kind(bench.random, 400 * rate)
        self._at = self._due = 0.0
        self.lost_at: int | None = None  # cycle at which the receiver first lost a byte
        self.off_at: int | None = None
        self._overruns = bench.board.stats().rx_overruns

    def go_on(self, ms: float) -> None:
        board = self.bench.board
        for _ in range(round(ms / PIECE_MS)):
            self._due += self.rate * PIECE_MS
            piece = self._bytes[int(self._at) : int(self._due)]
            self._at = self._due
            board.uart_send(piece)
            self.bench.wait(PIECE_MS)
            if self.lost_at is None and board.stats().rx_overruns > self._overruns:
                self.lost_at = board.cycle
            if self.off_at is None and not self.bench.motors_on:
                self.off_at = board.cycle


@pytest.mark.slow
@pytest.mark.parametrize("rate", [16, 96])
@pytest.mark.parametrize("kind", [garbage, requests, unfinished, too_long, zeros])
def test_motors_are_off_soon_after_a_stop_inside_a_flood_or_after_the_line_is_lost(
    bench: BoardWithImage, kind: Flood, rate: int
) -> None:
    bench.ask(schema.TelemetryRequest(1))
    for _ in range(3):
        enable(bench)
        flood = Pour(bench, kind, rate)
        flood.go_on(bench.random.uniform(20, 60))
        stopped_at = bench.board.cycle
        for sequence in (77, 77):  # as the host does: again after a while
            bench.board.uart_send(stop_message(sequence))
            flood.go_on(1000 * PATIENCE.stop_repeat_s)
        assert flood.off_at is not None
        since = max(stopped_at, flood.lost_at or 0) if flood.off_at >= stopped_at else flood.lost_at
        assert since is not None, "nothing but a stop or lost bytes turns the motors off"
        assert (flood.off_at - since) / CYCLES_PER_TICK < OFF_MS
        bench.board.uart_send(b"\0")
        bench.wait(20)
        seen = bench.status()
        assert seen.late_ticks == 0
        assert seen.fault in (schema.Fault.NONE, schema.Fault.FLOOD)


@pytest.mark.slow
@pytest.mark.parametrize(("count", "lossless"), [(140, True), (200, False)])
def test_a_short_burst_is_no_flood(bench: BoardWithImage, count: int, lossless: bool) -> None:
    """What an honest host may send without waiting (140 bytes), and nearly half as much again, in all phases."""
    enable(bench)
    for _ in range(20):
        bench.wait(bench.random.uniform(191.5, 192.5))
        bench.board.uart_send(bench.random.bytes(count) + b"\0")
    bench.wait(192)
    assert bench.status().fault is schema.Fault.NONE
    assert bench.motors_on
    assert bench.board.stats().rx_overruns == 0 or not lossless


@pytest.mark.slow
def test_a_stop_acts_although_one_byte_in_twenty_is_damaged(bench: BoardWithImage) -> None:
    line = Noise(seed=3)
    line.set("flip", 0.05)
    trials, late = 300, 0
    enable(bench)
    for trial in range(trials):
        begun = bench.board.cycle
        bench.board.uart_send(line(bytes([1, 2, 3])))  # what a damaged request has left behind
        while bench.motors_on:
            bench.board.uart_send(line(stop_message(trial % 255 + 1)))
            for _ in range(round(1000 * PATIENCE.stop_repeat_s)):
                bench.wait(1)
                if not bench.motors_on:
                    break
        late += (bench.board.cycle - begun) / CYCLES_PER_TICK > 50
        bench.board.uart_send(b"\0")
        enable(bench)
    assert late <= trials / 100
    assert bench.status().late_ticks == 0
