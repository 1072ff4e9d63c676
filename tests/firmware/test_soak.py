"""Everything at once on the real images, past the end of the tick counter: nothing is late, lost or unanswered."""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
import pytest

from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Message
from greywhale_sim.board_with_image import BoardWithImage
from greywhale_sim.wiring import BOARDS

ANSWER_MS = 25  # a set that is applied takes 12
EXCUSED = 4  # samples after the answer: what was lost shows at the next one
WRAP_AFTER = 4000  # ticks, until the counter of 32 bits begins anew
SECONDS = 20
PUSHED_BYTES = 2  # by an interrupt that comes later in a function than any before; what leaks pushes more in 10 s
MASK = (1 << 32) - 1
MOTION_MS = 2094  # a turn of some 3 rad/s
MOTION_MV = 2500.0 + 900.0 * np.sin(
    2 * np.pi / MOTION_MS * np.arange(1, MOTION_MS + 1)[:, None] + np.tile(np.arange(4.0), 2)
)  # the eight potentiometers in each millisecond


@dataclass
class Counts:
    """Counts of all that has happened; `lost_in_apply` are samples that may be missing while a set is applied."""

    requests: int = 0
    unanswered: int = 0
    samples: int = 0
    lost_samples: int = 0
    lost_in_apply: int = 0
    late_ticks: int = 0
    faults: int = 0
    applied: int = 0
    saved: int = 0
    enabled: int = 0
    wraps: int = 0


class Soak:
    """A host that takes a sample in every tick and asks for something all the time, one request after the other."""

    def __init__(self, board: str, seed: int) -> None:
        self.bench, self.counts = BoardWithImage(board), Counts()
        self.random = np.random.default_rng(seed)
        self._values = list(schema.DEFAULTS)
        self._decoder = frames.FrameDecoder()
        self._seq = 0
        self._last: tuple[int, int] | None = None  # sequence number and tick of the last sample
        self._excused = 0  # samples from now on of which some may be missing
        self._step_of_motion = 0
        self.bench.board.uart_receive()

    def set_counter(self, tick: int) -> None:
        """Put another value into the board's counter of ticks, which is found by how it counts."""
        start, _ = self.bench.ram
        places = set(range(self.bench.statics - 3))
        for _ in range(5):
            now = schema.StatusReply.unpack(self.ask(schema.StatusRequest)).tick
            memory = self.bench.board.peek(start, self.bench.statics)
            places = {at for at in places if 0 < int.from_bytes(memory[at : at + 4], "little") - now < 4}
            self.bench.wait(float(self.random.integers(1000)))
        (place,) = places
        self.bench.board.poke(start + place, struct.pack("<I", tick & MASK))
        self._last = None

    def run(self, seconds: float) -> None:
        end = self.bench.board.cycle + round(seconds * 16e6)
        while self.bench.board.cycle < end:
            self._do_something()
            for _ in range(int(self.random.integers(1, 20))):
                self._step()
        status = schema.StatusReply.unpack(self.ask(schema.StatusRequest))
        self.counts.late_ticks += status.late_ticks
        self.counts.lost_samples += status.telemetry_dropped if not self.counts.applied else 0

    def _do_something(self) -> None:
        kind = int(self.random.integers(10))
        if kind < 3:
            self._set_one()
        elif kind == 3:
            self._apply()
        elif kind == 4:
            self.counts.saved += bool(self.ask(schema.ParamSaveRequest))
        elif kind < 7:
            self.counts.enabled += bool(self.ask(schema.EnableRequest, struct.pack("<H", 2000)))
        elif kind == 7:
            self.ask(schema.StopRequest)
        else:
            status = schema.StatusReply.unpack(self.ask(schema.StatusRequest))
            self.counts.faults += status.state is schema.State.FAULT

    def _set_one(self) -> None:
        parameter = schema.PARAMETERS[schema.PARAMETER_BY_NAME["joint0.kp"].index + int(self.random.integers(3))]
        self._values[parameter.index] = parameter.default + int(self.random.integers(50))
        self.ask(schema.ParamSetRequest, struct.pack("<Hi", parameter.index, self._values[parameter.index]))

    def _apply(self) -> None:
        """Only with the motors off and no save under way, as the board demands."""
        self.ask(schema.StopRequest)
        if schema.StatusReply.unpack(self.ask(schema.StatusRequest)).save_state is schema.SaveState.SAVING:
            return
        self._excused = ANSWER_MS + EXCUSED
        crc = struct.pack("<H", schema.param_crc(self._values))
        self.counts.applied += bool(self.ask(schema.ParamApplyRequest, crc))
        self._excused = EXCUSED

    def ask(self, message: type[Message], payload: bytes = b"") -> bytes:
        """The payload of the answer; empty, and counted, where none comes."""
        self.counts.requests += 1
        self._seq = self._seq % 255 + 1
        self.bench.board.uart_send(frames.encode_frame(message.TYPE, self._seq, payload))
        for _ in range(ANSWER_MS):
            for frame in self._step():
                if (frame.type, frame.seq) == (message.TYPE | 0x80, self._seq):
                    return frame.payload or b"\0"
        self.counts.unanswered += 1
        return b""

    def _step(self) -> list[frames.Frame]:
        """One millisecond: the arms move together, and what has come is looked at."""
        self._step_of_motion = (self._step_of_motion + 1) % len(MOTION_MV)
        self.bench.board.set_millivolts(MOTION_MV[self._step_of_motion])
        self.bench.wait(1)
        answers = []
        for frame in self._decoder.feed(self.bench.board.uart_receive()):
            if frame.type == schema.Sample.TYPE:
                self.take(frame.seq, int.from_bytes(frame.payload[:4], "little"))
            else:
                answers.append(frame)
        return answers

    def take(self, seq: int, tick: int) -> None:
        """A sample has come."""
        self.counts.samples += 1
        if self._last is not None:
            missing = (tick - self._last[1] - 1) & MASK
            if missing and self._excused:
                self.counts.lost_in_apply += missing
            elif missing or (seq - self._last[0]) & 255 != 1:
                self.counts.lost_samples += max(missing, 1)
            self._excused = max(0, self._excused - 1)
            self.counts.wraps += tick < self._last[1]
        self._last = (seq, tick)


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS)
def test_nothing_is_late_or_lost_while_everything_happens_at_once(board: str) -> None:
    soak = Soak(board, seed=2)
    soak.set_counter(MASK - WRAP_AFTER)
    soak.ask(schema.TelemetryRequest, struct.pack("<H", 1))
    soak.run(SECONDS / 2)
    stack = soak.bench.stack()
    soak.run(SECONDS / 2)
    counts = soak.counts
    assert (counts.unanswered, counts.lost_samples, counts.late_ticks, counts.faults) == (0, 0, 0, 0)
    assert soak.bench.stack() - stack <= PUSHED_BYTES
    assert counts.wraps == 1
    assert min(counts.applied, counts.saved, counts.enabled) > 20
    assert counts.samples > 15_000
