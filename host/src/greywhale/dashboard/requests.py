"""The requests of all clients on their way to one board: numbers of the relay's own, and one at a time."""

from __future__ import annotations

import contextlib
from collections import deque
from typing import NamedTuple

from greywhale.base.errors import UserError
from greywhale.board.device import stop_message
from greywhale.dashboard.client import Client
from greywhale.dashboard.limits import BOARD
from greywhale.protocol import schema
from greywhale.protocol.frames import Frame, encode_frame
from greywhale.protocol.transport import Line


class Asked(NamedTuple):
    """The client whose request a number stands for; without one it is the relay's own."""

    type: int
    client: Client | None = None
    seq: int = 0


class Requests:
    """To one board after the other; the relay lets one thread in at a time."""

    def __init__(self) -> None:
        self._line: Line | None = None
        self._asked: dict[int, Asked] = {}
        self._sequence = 0
        self._waiting: deque[tuple[Asked, bytes]] = deque(maxlen=BOARD.most_waiting)  # requests, with their payloads
        self._on_its_way: int | None = None  # the number of the last that was sent, until its answer
        self._sent_s = 0.0

    def begin(self, line: Line) -> None:
        self._line = line
        self.forget()

    def forget(self) -> None:
        """No answer comes any more to what was asked."""
        self._asked.clear()
        self._waiting.clear()
        self._on_its_way = None

    def look(self, now_s: float) -> None:
        """Send the next where the one before has had its time."""
        if now_s > self._sent_s + BOARD.answer_s:
            self._on_its_way = None
        self._send_next()

    def send(self, asked: Asked, payload: bytes) -> None:
        self._write(encode_frame(asked.type, self._number(asked), payload))

    def send_stop(self, client: Client | None = None, seq: int = 0) -> None:
        self._write(stop_message(self._number(Asked(schema.StopRequest.TYPE, client, seq))))

    def send_soon(self, asked: Asked, payload: bytes) -> None:
        """Send a request when the one before is answered; one that renews a lease goes before all others."""
        if asked.type == schema.RenewRequest.TYPE:
            self._waiting.appendleft((asked, payload))
        else:
            self._waiting.append((asked, payload))
        self._send_next()

    def answered(self, frame: Frame) -> Asked | None:
        """The request that a frame of the board answers, if any; the next one goes out."""
        asked = self._asked.get(frame.seq)
        if asked is None or frame.type not in (schema.Nack.TYPE, asked.type | schema.REPLY_BIT):
            return None
        if frame.seq == self._on_its_way:
            self._on_its_way = None
            self._send_next()
        return asked

    def _send_next(self) -> None:
        if self._waiting and self._on_its_way is None:
            self.send(*self._waiting.popleft())

    def _write(self, data: bytes) -> None:
        assert self._line is not None
        with contextlib.suppress(UserError):  # who holds the port finds out by itself that it went away
            self._line.write(data)

    def _number(self, asked: Asked) -> int:
        assert self._line is not None
        self._sequence = self._sequence % 255 + 1
        self._asked[self._sequence] = asked
        self._on_its_way, self._sent_s = self._sequence, self._line.clock()
        return self._sequence
