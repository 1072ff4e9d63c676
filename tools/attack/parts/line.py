"""A bad line between the host and the real image: nothing that was not sent may act."""

from __future__ import annotations

import struct
from collections.abc import Callable

import numpy as np

from greywhale.protocol import frames, schema
from greywhale.protocol.declared import Message
from greywhale_sim.board_with_image import CYCLES_PER_TICK, BoardWithImage
from greywhale_sim.wiring import BOARDS
from tools.attack.damage import DAMAGES, damage
from tools.attack.part import Part, Piece, Row

FAULTS, PER_PIECE = 100_000, 1000
RATES = (0.003, 0.01, 0.05)
CHANGED = [parameter.index for parameter in schema.PARAMETERS if not parameter.nonzero]
SHARES = ", ".join(f"{100 * rate:g}" for rate in RATES)
CLEAN_EVERY = 200  # requests
PATIENCE_MS = 12  # as long as a set takes to be applied
RECOVERY_MS = 12  # a set that is being applied takes as long; a stop alone 1 ms


class Session:
    """A host that sends requests at random over a line that damages them, and checks all that comes back."""

    def __init__(
        self, bench: BoardWithImage, kind: str, seed: int, damaged: Callable[..., tuple[bytes, int]] = damage
    ) -> None:
        self.bench, self.kind = bench, kind
        self.random = np.random.default_rng((seed, list(DAMAGES).index(kind)))
        self.staged, self.asked = list(schema.DEFAULTS), {schema.param_crc(schema.DEFAULTS)}
        self.enabled = self.stopped = 0  # the numbers of the last enable and of the last stop that was confirmed
        self.faults = self.answers = self.violations = 0
        self.recovery_ms = 0
        self._damaged = damaged
        self._number = 0
        self._sent: dict[int, tuple[int, bytes, int]] = {}
        self._decoder = frames.FrameDecoder()
        bench.board.uart_receive()  # the greeting after boot belongs to no request

    def go_on(self, rate: float) -> None:
        """Some requests, each after the last one's answer or some patience, then a line that is well again."""
        for _ in range(CLEAN_EVERY):
            self._send(*self._some_request(), rate=rate)
            self._wait(PATIENCE_MS)
        self._recover()

    def _wait(self, patience_ms: int) -> None:
        """Until the last request is answered, but not longer."""
        for _ in range(patience_ms):
            if any(frame.seq == self._number % 255 + 1 for frame in self._step()):
                return

    def _some_request(self) -> tuple[type[Message], bytes]:
        kind = self.random.integers(12)
        if kind < 5:
            index = int(self.random.choice(CHANGED))
            parameter = schema.PARAMETERS[index]
            near = schema.DEFAULTS[index] + int(self.random.integers(-20, 21))  # so that most sets can be run
            value = min(max(near, parameter.minimum), parameter.maximum)
            self.staged[index] = value
            return schema.ParamSetRequest, struct.pack("<Hi", index, value)
        if kind == 5:
            self.asked.add(schema.param_crc(self.staged))
            return schema.ParamApplyRequest, struct.pack("<H", schema.param_crc(self.staged))
        if kind == 6:
            self.staged = list(schema.DEFAULTS)
            return schema.ParamDefaultsRequest, b""
        if kind == 7:
            self.enabled = self._number + 1
            return schema.EnableRequest, struct.pack("<H", int(self.random.integers(1, 60)))
        simple = (schema.StopRequest, schema.StatusRequest, schema.HelloRequest, schema.ClearFaultRequest)
        return simple[kind - 8], b""

    def _send(self, message: type[Message], payload: bytes, rate: float = 0.0) -> None:
        self._number += 1
        seq = self._number % 255 + 1
        self._sent[seq] = (message.TYPE, payload, self._number)
        frame = frames.encode_frame(message.TYPE, seq, payload)
        data, faults = self._damaged(self.random, frame, self.kind, rate)
        self.faults += faults
        self.bench.board.uart_send(data)

    def _step(self) -> list[frames.Frame]:
        self.bench.wait(1)
        found = self._decoder.feed(self.bench.board.uart_receive())
        for frame in found:
            self._check(frame)
        if self.bench.motors_on and self.enabled <= self.stopped:
            self.violations += 1
        return found

    def _check(self, frame: frames.Frame) -> None:
        """An answer belongs to a request that was sent, and repeats what it has done."""
        self.answers += 1
        sent_type, payload, number = self._sent.get(frame.seq, (0, b"", 0))
        refused = frame.type == schema.Nack.TYPE
        wrong = frame.payload[0] != sent_type if refused else frame.type != sent_type | 0x80
        if frame.type == schema.ParamSetReply.TYPE:
            wrong |= frame.payload != payload
        if frame.type == schema.ParamApplyReply.TYPE:
            wrong |= int.from_bytes(frame.payload, "little") not in self.asked
        if frame.type == schema.HelloReply.TYPE:
            wrong |= schema.HelloReply.unpack(frame.payload).param_crc not in self.asked
        if frame.type == schema.StopReply.TYPE:
            self.stopped = number
        self.violations += wrong

    def _recover(self) -> None:
        """A zero and a stop over a line that is well again: it must act, and be answered, within some milliseconds."""
        begun = self.bench.board.cycle
        self.bench.board.uart_send(b"\0")
        self._send(schema.StopRequest, b"")
        self._wait(10 * RECOVERY_MS)
        took = round((self.bench.board.cycle - begun) / CYCLES_PER_TICK)
        self.recovery_ms = max(self.recovery_ms, took)
        self.violations += took > RECOVERY_MS or self.stopped < self._number
        self._send(schema.HelloRequest, b"")
        self._wait(RECOVERY_MS)


def run(piece: Piece) -> list[Row]:
    bench = BoardWithImage(piece["board"])
    session = Session(bench, piece["kind"], piece["seed"])
    turn = 0
    while session.faults < piece["trials"]:
        session.go_on(RATES[turn % len(RATES)])
        turn += 1
    return [
        Row(
            f"{piece['board'].title()}: {piece['kind']}",
            session.faults,
            session.violations,
            {"answers": session.answers},
            {"ms to recover": session.recovery_ms},
        )
    ]


def pieces(share: float) -> list[Piece]:
    each = max(1, round(FAULTS * share / len(DAMAGES) / len(BOARDS)))
    return [
        {"board": board, "kind": kind, "seed": start, "trials": min(PER_PIECE, each - start)}
        for board in BOARDS
        for kind in DAMAGES
        for start in range(0, each, PER_PIECE)
    ]


PART = Part(
    "line",
    "A bad line to the board",
    f"""The real images on both simulated boards. A host sends requests (parameters, apply, defaults, enable, stop,
clear_fault, hello, status), and {SHARES} % of the bytes are damaged, one kind of damage at a time. Every answer must
belong to a request that was sent and repeat its values, the running set must be one whose CRC was sent, no motor may
be on unless an enable was sent after the last confirmed stop. After every {CLEAN_EVERY} requests the line is well
again: a zero and a `stop` must then be answered within {RECOVERY_MS} ms. A trial is one place of damage.""",
    ("firmware/lib", "firmware/src", "shared", "sim/board", "tools/attack/damage.py"),
    pieces,
    run,
)
