"""A board in Python on a line in this process: only for what a host does when things go wrong.

It answers as the firmware should, and `faults` spoils that: lost answers, refusals, garbage, a restart, an unplugged
cable. Its time runs only while its host reads or waits.
"""

from __future__ import annotations

import contextlib
import itertools
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Self

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.protocol import schema
from greywhale.protocol.declared import Message
from greywhale.protocol.frames import FrameDecoder, encode_frame
from greywhale.protocol.schema import Fault, NackCode, SaveState, State, StopReason
from greywhale.protocol.transport import LINES, PortLostError

SOFT_START_TICKS = 20
FOLLOWERS = (1, 2, 3, 4)
# A host that leads: room for so many points, one played every so many ticks.
_ROOM, _POINT_TICKS = 12, 16
SAVE_POLLS = 3
_TICK_S = 0.001
_numbers = itertools.count()


@dataclass
class Faults:
    """Things that go wrong."""

    silent: bool = False
    chatter: bytes = b""  # said over and over until it answers a request: opening a port drops what was said before
    lose: Counter[int] = field(default_factory=Counter)  # request type -> how many answers get lost
    refuse: dict[int, tuple[NackCode, int]] = field(default_factory=dict)  # request type -> nack
    refuse_times: Counter[int] = field(default_factory=Counter)  # request type -> how often (0: always)
    hello: bytes | None = None  # instead of the right payload
    replies: dict[int, bytes] = field(default_factory=dict)  # request type -> payload instead of the right one
    echo_error: int = 0  # added to the echoed value of param_set
    read_error: int = 0  # added to the index that param_get answers
    read_garbled: int | None = None  # index of a parameter of which another value is answered
    lose_ticks: frozenset[int] = frozenset()  # samples that get lost
    repeat_ticks: frozenset[int] = frozenset()  # samples that come twice
    restart_at: int | None = None  # tick at which the board restarts
    restart_says_hello: bool = True
    jump_at: tuple[int, int] | None = None  # tick at which the clock jumps, and by how many ticks
    unplug_at: int | None = None
    stop_sampling_at: int | None = None
    fault_at: tuple[int, Fault, int] | None = None  # tick, fault, where
    save_result: SaveState = SaveState.SAVED
    wrong_crc_after_apply: bool = False
    followers: tuple[int, int, int, int] = FOLLOWERS  # where the arm is


_CLUTCH = {
    schema.ClutchAction.ENGAGE: schema.Clutch.SHIFTED,
    schema.ClutchAction.DISENGAGE: schema.Clutch.DISENGAGED,
    schema.ClutchAction.RESET: schema.Clutch.ENGAGED,
}


class FakeBoard:
    """Use as a context manager; `port` is what a host opens, the other attributes are what a test looks at."""

    def __init__(self, faults: Faults | None = None) -> None:
        self.faults = faults or Faults()
        self.state = State.DISABLED
        self.stop_reason = StopReason.NONE
        self.fault = Fault.NONE
        self.fault_where = 0xFF
        self.tick = 0
        self.running = list(schema.DEFAULTS)
        self.stored = list(schema.DEFAULTS)
        self.staged = list(schema.DEFAULTS)
        self.requests: list[tuple[int, int]] = []  # type, seq
        self.port = f"board {next(_numbers)}"
        self.restarted = True  # by the last opening
        self._opened = self._gone = False
        self._to_host = b""
        self._now = 0.0
        self.leading = False
        self._points: list[tuple[int, int, int, int]] = []  # that wait to be played
        self._next_point = 0
        self._reference = FOLLOWERS
        self._every = 0
        self._lease_ms = 0
        self._lease_end = 0
        self._saving = 0
        self._save_state = SaveState.IDLE
        self.saves = 0
        self.param_source = schema.ParamSource.DEFAULTS
        self.clutch = schema.Clutch.ENGAGED
        self._samples = 0
        self._enabled_at = 0
        self._decoder = FrameDecoder()

    def __enter__(self) -> Self:
        LINES[self.port] = self.open
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        del LINES[self.port]

    def asked(self, request: type[Message]) -> int:
        """The number of frames of this request that arrived, repeats included."""
        return sum(1 for kind, _ in self.requests if kind == request.TYPE)

    @property
    def lease_ms(self) -> int:
        """The lease of the motors, 0 for none."""
        return self._lease_ms

    def own_hello(self) -> bytes:
        """The frame that a board sends by itself when it has started."""
        return encode_frame(schema.HelloReply.TYPE, 0, self.hello())

    def hello(self) -> bytes:
        """The payload with which the board tells who it is."""
        if self.faults.hello is not None:
            return self.faults.hello
        crc = schema.param_crc(self.running)
        return schema.HelloReply(
            schema.PROTOCOL, 0, 1, 0, schema.SCHEMA_HASH, schema.Board.MEGA2560, crc, self.param_source,
            schema.ResetCause.EXTERNAL,
        ).pack()  # fmt: skip

    def say(self, data: bytes) -> None:
        """Bytes to the host, whatever they mean."""
        self._to_host += data

    # --- the line, as a host has it ---------------------------------------------------------------------------------

    def open(self, restart: bool, baud: int) -> Self:
        if self._gone:
            raise UserError(f"{self.port}: there is no such port.")
        self.restarted, self._opened = restart or not self._opened, True
        self._to_host = b""
        return self

    def read(self) -> bytes:
        """Live until there is something to read, a tick at most."""
        if not self._to_host:
            self.wait(_TICK_S)
        if self._gone:
            raise PortLostError(self.port)
        taken, self._to_host = self._to_host, b""
        return taken

    def write(self, data: bytes) -> None:
        if self._gone:
            raise PortLostError(self.port)
        self.hear(data)

    def clock(self) -> float:
        return self._now

    def wait(self, seconds: float) -> None:
        end = self._now + seconds
        while self._now < end:
            self._now += _TICK_S
            self.live()

    def close(self) -> None:
        """Nothing is open."""

    # --- the board's life -------------------------------------------------------------------------------------------

    @property
    def chatters(self) -> bool:
        return bool(self.faults.chatter) and (self.faults.silent or not self.requests)

    def hear(self, data: bytes) -> None:
        """Bytes from the host."""
        for frame in self._decoder.feed(data):
            self.requests.append((frame.type, frame.seq))
            if not self.faults.silent:
                self._request(frame.type, frame.seq, frame.payload)

    def live(self) -> None:
        """A tick, if the board has anything to tell."""
        if self._every:
            self._live_a_tick()
        elif self.chatters:
            self.say(self.faults.chatter)

    def _live_a_tick(self) -> None:
        faults = self.faults
        self.tick += 1
        if faults.jump_at is not None and self.tick >= faults.jump_at[0]:
            self.tick, faults.jump_at = self.tick + faults.jump_at[1], None
        if faults.unplug_at is not None and self.tick >= faults.unplug_at:
            self.unplug()
            return
        if faults.restart_at is not None and self.tick >= faults.restart_at:
            self._restart()
            return
        if faults.fault_at is not None and self.tick >= faults.fault_at[0]:
            _, self.fault, self.fault_where = faults.fault_at
            self.state, self.stop_reason = State.FAULT, StopReason.FAULT
        if self.state in (State.SOFT_START, State.FOLLOWING):
            if self._lease_ms and self.tick > self._lease_end:
                self.state, self.stop_reason = State.DISABLED, StopReason.LEASE
            elif self.tick >= self._enabled_at + SOFT_START_TICKS:
                self.state = State.FOLLOWING
            if self._points and self.tick % _POINT_TICKS == 0:
                (a, b, c, d), (to_a, to_b, to_c, to_d) = self._reference, self._points.pop(0)
                self._reference = (a + 4 * to_a, b + 4 * to_b, c + 4 * to_c, d + 4 * to_d)
        if self.tick % self._every == 0:
            self._sample()

    def _sample(self) -> None:
        self._samples += 1
        lost = self.tick in self.faults.lose_ticks
        stopped = self.faults.stop_sampling_at is not None and self.tick >= self.faults.stop_sampling_at
        if lost or stopped:
            return
        # An arm that is led follows at once; another one stays where it is.
        leaders = self._reference if self.leading else (self.tick % 4096, 0, -100, 200)
        followers = self._reference if self.leading else self.faults.followers
        sample = schema.Sample(self.tick, self.state, self.fault, leaders, followers, (15000, -15000, 0, 1))
        times = 2 if self.tick in self.faults.repeat_ticks else 1
        self.say(times * encode_frame(schema.Sample.TYPE, self._samples % 256, sample.pack()))

    def unplug(self) -> None:
        self._every, self._gone = 0, True

    def _restart(self) -> None:
        self.faults.restart_at = None
        self.tick = self._every = self._lease_ms = 0
        self.state, self.stop_reason = State.DISABLED, StopReason.RESET
        self.running = list(self.stored)
        if self.faults.restart_says_hello:
            self.say(self.own_hello())

    # --- requests ---------------------------------------------------------------------------------------------------

    def _request(self, kind: int, seq: int, payload: bytes) -> None:
        if kind in self.faults.refuse:
            code, detail = self.faults.refuse[kind]
            if self.faults.refuse_times[kind] == 1:
                del self.faults.refuse[kind]
            self.faults.refuse_times[kind] -= 1
            self._answer(schema.Nack.TYPE, seq, schema.Nack(kind, code, detail).pack())
            return
        spoilt = self.faults.replies.get(kind)
        reply = self._reply(kind, payload) if spoilt is None else spoilt
        if self.faults.lose[kind] > 0:
            self.faults.lose[kind] -= 1
            return
        self._answer(kind | schema.REPLY_BIT, seq, reply)

    def _answer(self, kind: int, seq: int, payload: bytes) -> None:
        self.say(encode_frame(kind, seq, payload))

    def _reply(self, kind: int, payload: bytes) -> bytes:
        match kind:
            case schema.HelloRequest.TYPE:
                return self.hello()
            case schema.StatusRequest.TYPE:
                return self._status()
            case schema.ParamGetRequest.TYPE:
                index = schema.ParamGetRequest.unpack(payload).index
                value = self.running[index] + (index == self.faults.read_garbled)
                return schema.ParamGetReply(index + self.faults.read_error, value).pack()
            case schema.ParamSetRequest.TYPE:
                request = schema.ParamSetRequest.unpack(payload)
                self.staged[request.index] = request.value
                return schema.ParamSetReply(request.index, request.value + self.faults.echo_error).pack()
            case schema.ParamApplyRequest.TYPE:
                assert schema.ParamApplyRequest.unpack(payload).crc == schema.param_crc(self.staged)
                self.running = list(schema.DEFAULTS) if self.faults.wrong_crc_after_apply else list(self.staged)
                return schema.ParamApplyReply(schema.param_crc(self.running)).pack()
            case schema.ParamSaveRequest.TYPE:
                self._saving, self._save_state = SAVE_POLLS, SaveState.SAVING
                return schema.ParamSaveReply(schema.param_crc(self.running)).pack()
            case schema.EnableRequest.TYPE | schema.RenewRequest.TYPE:
                return self._lease(kind, schema.EnableRequest.unpack(payload).lease_ms)
            case schema.LeadRequest.TYPE:
                self.leading, self._points, self._next_point, self._reference = True, [], 0, FOLLOWERS
                state = schema.EnableReply.unpack(self._lease(kind, schema.LeadRequest.unpack(payload).lease_ms)).state
                return schema.LeadReply(state, 0, self._reference).pack()
            case schema.LeadPointRequest.TYPE:
                point = schema.LeadPointRequest.unpack(payload)
                if point.number == self._next_point and len(self._points) < _ROOM:
                    self._points.append(point.step)
                    self._next_point = (self._next_point + 1) % 256
                return schema.LeadPointReply(self._next_point, len(self._points)).pack()
            case schema.ClutchRequest.TYPE:
                self.clutch = _CLUTCH[schema.ClutchRequest.unpack(payload).action]
                return schema.ClutchReply(self.clutch).pack()
            case schema.StopRequest.TYPE:
                self.state, self.stop_reason = State.DISABLED, StopReason.HOST
                return schema.StopReply(self.state).pack()
            case schema.TelemetryRequest.TYPE:
                self._every = schema.TelemetryRequest.unpack(payload).every
                return schema.TelemetryReply(self._every).pack()
            case schema.ClearFaultRequest.TYPE:
                self.state, self.fault, self.fault_where = State.DISABLED, Fault.NONE, 0xFF
                return schema.ClearFaultReply(self.state).pack()
        raise AssertionError(f"unexpected request {kind:#04x}")

    def _lease(self, kind: int, lease_ms: int) -> bytes:
        if kind == schema.EnableRequest.TYPE:
            self.leading = False
        if kind != schema.RenewRequest.TYPE and self.state is State.DISABLED:
            self.state, self._enabled_at = State.SOFT_START, self.tick
        self._lease_ms = lease_ms
        self._lease_end = self.tick + lease_ms
        return schema.EnableReply(self.state).pack()

    def _status(self) -> bytes:
        if self._save_state is SaveState.SAVING:
            self._saving -= 1
            if self._saving == 0:
                self._save_state = self.faults.save_result
                if self._save_state is SaveState.SAVED:
                    self.saves += self.stored != self.running
                    self.stored = list(self.running)
        return schema.StatusReply(
            self.state, self.stop_reason, self.fault, self.fault_where, self.tick, 0, 0, 0, 0, 0, 300, self._save_state,
            self.saves, self.clutch,
        ).pack()  # fmt: skip


def open_device(board: FakeBoard) -> Device:
    """A device that does not wait for a bootloader."""
    return Device(board.port, quiet_s=0.0, patience_s=0.5)


@contextlib.contextmanager
def served(faults: Faults | None = None) -> Iterator[tuple[FakeBoard, Device]]:
    """A board and a device that talks with it."""
    with FakeBoard(faults) as board, open_device(board) as device:
        yield board, device
