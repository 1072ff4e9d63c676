"""A board in Python on a pseudo terminal: only for what a host does when things go wrong.

It answers as the firmware should, and `faults` spoils that: lost answers, refusals, garbage, a restart, an unplugged
cable. Its time runs with the samples it sends, and waits while its host has not read them.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import select
import struct
import subprocess
import sys
import termios
import threading
import time
import tty
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from types import TracebackType
from typing import Self

from greywhale.protocol import schema
from greywhale.protocol.declared import Message
from greywhale.protocol.frames import FrameDecoder, encode_frame
from greywhale.protocol.schema import Fault, NackCode, SaveState, State, StopReason

SOFT_START_TICKS = 20
FOLLOWERS = (1, 2, 3, 4)
# A host that leads: room for so many points, one played every so many ticks.
_ROOM, _POINT_TICKS = 12, 16
SAVE_POLLS = 3
# More unread bytes than this stop the board's time, as they stop the bench's.
_UNREAD = 256
_TICK_S = 0.0002


@dataclass
class Faults:
    """What goes wrong."""

    silent: bool = False
    chatter: bytes = b""  # said over and over until it answers a request: opening a port drops what was said before
    lose: Counter[int] = field(default_factory=Counter)  # request type -> how many answers get lost
    refuse: dict[int, tuple[NackCode, int]] = field(default_factory=dict)  # request type -> nack
    refuse_times: Counter[int] = field(default_factory=Counter)  # request type -> how often (0: always)
    garbage: bytes = b""  # before every answer
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
    patience_s: float = 5.0  # so long it waits for a busy host before a lease runs out


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
        self.problem: BaseException | None = None
        self._alone = self._busy = False
        self._heard_s = 0.0
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
        self._samples = 0
        self._enabled_at = 0
        self._decoder = FrameDecoder()
        self._end = threading.Event()
        self._changed = threading.Condition()
        self._ticks_in_state = 0

    def __enter__(self) -> Self:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        flags = termios.tcgetattr(self._slave)
        flags[2] |= termios.HUPCL  # as serial ports have it, unlike pseudo-terminals
        termios.tcsetattr(self._slave, termios.TCSANOW, flags)
        os.set_blocking(self._master, False)
        self.port = os.ttyname(self._slave)
        self._wake_out, self._wake_in = os.pipe()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end.set()
        os.write(self._wake_in, b"x")
        self._thread.join(10)
        assert not self._thread.is_alive()
        for descriptor in (self._master, self._slave, self._wake_in, self._wake_out):
            if descriptor >= 0:
                os.close(descriptor)
        if self.problem is not None and error is None:
            raise self.problem

    def asked(self, request: type[Message]) -> int:
        """How many frames of this request arrived, repeats included."""
        return sum(1 for kind, _ in self.requests if kind == request.TYPE)

    @property
    def lease_ms(self) -> int:
        """The lease of the motors, 0 for none."""
        return self._lease_ms

    def wait_for(self, state: State, ticks: int, host: subprocess.Popen[str]) -> None:
        """Return when the board has been in this state for so many ticks, or fail when its host ends before."""

        def reached() -> bool:
            return self.problem is not None or (self.state is state and self._ticks_in_state >= ticks)

        with self._changed:
            while not self._changed.wait_for(reached, timeout=0.5):
                assert host.poll() is None, f"the host ended with {host.returncode}: {host.communicate()}"
        assert self.problem is None

    def own_hello(self) -> bytes:
        """The frame that a board sends by itself when it has started."""
        return encode_frame(schema.HelloReply.TYPE, 0, self.hello())

    def hello(self) -> bytes:
        """The payload with which the board tells who it is."""
        if self.faults.hello is not None:
            return self.faults.hello
        crc = schema.param_crc(self.running)
        return schema.HelloReply(
            schema.PROTOCOL, 0, 1, 0, schema.SCHEMA_HASH, schema.Board.MEGA2560, crc, schema.ParamSource.DEFAULTS,
            schema.ResetCause.EXTERNAL,
        ).pack()  # fmt: skip

    def hurry(self) -> None:
        """Nobody listens any more: what the board says is lost, and its time goes on as quickly as it can. Returns when
        it has done what it was asked to.
        """
        self._alone = True
        while self.problem is None and (select.select([self._master], [], [], 0)[0] or self._busy):
            time.sleep(0.0002)

    def say(self, data: bytes) -> None:
        """Bytes to the host, whatever they mean."""
        while data and not self._alone and not self._end.is_set():
            try:
                data = data[os.write(self._master, data) :]
            except BlockingIOError:
                select.select([self._wake_out], [self._master], [])

    # --- the board's life -------------------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            while not self._end.is_set() and self._master >= 0:
                room = self._alone or (self._unread() < _UNREAD and not self._waits_for_host())
                sampling = self._every > 0 and room
                chattering = bool(self.faults.chatter) and (self.faults.silent or not self.requests)
                # A tick takes a moment, in which the kernel moves what was written to where it counts as unread.
                timeout = 0.0 if self._alone else _TICK_S if self._every or chattering else None
                ready, _, _ = select.select([self._master, self._wake_out], [], [], timeout)
                if self._master in ready:
                    self._busy, self._heard_s = True, time.monotonic()
                    for frame in self._decoder.feed(os.read(self._master, 4096)):
                        self.requests.append((frame.type, frame.seq))
                        if not self.faults.silent:
                            self._request(frame.type, frame.seq, frame.payload)
                    self._busy = False
                elif sampling:
                    self._live_a_tick()
                elif chattering and room:
                    self.say(self.faults.chatter)
        except BaseException as error:
            with self._changed:
                self.problem = error
                self._changed.notify_all()

    def _waits_for_host(self) -> bool:
        """What this side wrote is some time on its way, on a busy machine for longer than many ticks take."""
        late = self._lease_ms and self.state in (State.SOFT_START, State.FOLLOWING)
        if not late or self.tick < self._lease_end - self._lease_ms // 2:
            return False
        return time.monotonic() < self._heard_s + self.faults.patience_s

    def _unread(self) -> int:
        # What this side wrote and the host has not read waits in the other end's input queue.
        waiting = fcntl.ioctl(self._slave, termios.FIONREAD, b"\0\0\0\0")
        return int(struct.unpack("i", waiting)[0])

    def _live_a_tick(self) -> None:
        faults, before = self.faults, self.state
        self.tick += 1
        if faults.jump_at is not None and self.tick >= faults.jump_at[0]:
            self.tick, faults.jump_at = self.tick + faults.jump_at[1], None
        if faults.unplug_at is not None and self.tick >= faults.unplug_at:
            self._unplug()
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
        with self._changed:
            self._ticks_in_state = self._ticks_in_state + 1 if self.state is before else 0
            self._changed.notify_all()
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

    def _unplug(self) -> None:
        # The host holds the other end of the pair; hanging up means closing both of ours.
        self._every = 0
        os.close(self._master)
        os.close(self._slave)
        self._master = self._slave = -1

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
        self.say(self.faults.garbage + encode_frame(kind, seq, payload))

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
            self.saves,
        ).pack()  # fmt: skip


@contextlib.contextmanager
def locked(port: str) -> Iterator[int]:
    """A process that has the port open for itself alone, and is no greywhale: its number."""
    take = (
        "import fcntl, sys; f = open(sys.argv[1], 'rb', 0); fcntl.flock(f, fcntl.LOCK_EX); print(flush=True); input()"
    )
    command = [sys.executable, "-c", take, port]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        yield process.pid
        process.communicate(b"\n")
