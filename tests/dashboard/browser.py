"""Behaves towards the server like a browser's page, without a browser: requests and WebSockets over the loopback."""

from __future__ import annotations

import http.client
import json
import select
import socket
from collections.abc import Callable, Mapping
from types import TracebackType
from typing import Any, Self

from wsproto import ConnectionType, WSConnection
from wsproto.events import AcceptConnection, BytesMessage, CloseConnection, Ping, RejectConnection, Request, TextMessage

from greywhale.protocol.declared import Message
from greywhale.protocol.frames import Frame, FrameDecoder, encode_frame

PATIENCE_S = 60.0  # a server that says nothing for so long has hung


class Page:
    """A page of the server at this port, with its token."""

    def __init__(self, port: int, token: str) -> None:
        self.port = port
        self.token = token
        self.ticket = ""

    def ask(
        self, method: str, path: str, body: object = None, headers: Mapping[str, str] | None = None
    ) -> tuple[int, bytes]:
        """Status and body of an answer; `headers` come over the usual ones."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        given = {"X-Greywhale-Token": self.token, **(headers or {})}
        sent = body if isinstance(body, bytes | None) else json.dumps(body).encode()
        try:
            connection.request(method, path, sent, given)
            answer = connection.getresponse()
            return answer.status, answer.read()
        finally:
            connection.close()

    def get(self, path: str) -> Any:
        """The server's answer in JSON."""
        status, body = self.ask("GET", path)
        assert status == 200, body
        return json.loads(body)

    def open(self, path: str, **options: Any) -> WebSocket:
        return WebSocket(self.port, path, self.token, **options)


class RefusedError(Exception):
    """The server did not accept a WebSocket; `status` is its answer."""

    def __init__(self, status: int) -> None:
        super().__init__(f"status {status}")
        self.status = status


class WebSocket:
    """One connection, a context. `closed` is the code with which the server ended it."""

    def __init__(
        self, port: int, path: str, token: str, host: str | None = None, headers: Mapping[str, str] | None = None
    ) -> None:
        self.closed: int | None = None
        self._socket = socket.create_connection(("127.0.0.1", port), PATIENCE_S)
        self._connection = WSConnection(ConnectionType.CLIENT)
        self._arrived: list[bytes | str] = []
        self._parts: list[bytes | str] = []
        self._accepted = False
        extra = [(name.encode(), value.encode()) for name, value in (headers or {}).items()]
        offered = ["greywhale", f"token.{token}"]
        self._send(Request(host or f"127.0.0.1:{port}", path, subprotocols=offered, extra_headers=extra))
        try:
            while not self._accepted:
                self._receive()
        except RefusedError:
            self._socket.close()
            raise

    def say(self, message: bytes | Mapping[str, object]) -> None:
        """Frames, or a message in words."""
        data = message if isinstance(message, bytes) else json.dumps(message)
        self._send(BytesMessage(data=data) if isinstance(data, bytes) else TextMessage(data=data))

    def take(self, meanwhile: Callable[[], None] | None = None) -> bytes | str:
        """The next message; ConnectionError where the server has closed. `meanwhile` is done while none is there."""
        while not self._arrived:
            if self.closed is not None:
                raise ConnectionError(self.closed)
            if meanwhile is not None and not select.select([self._socket], [], [], 0)[0]:
                meanwhile()
            else:
                self._receive()
        return self._arrived.pop(0)

    def close(self) -> None:
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _send(self, event: Any) -> None:
        self._socket.sendall(self._connection.send(event))

    def _receive(self) -> None:
        data = self._socket.recv(65536)
        self._connection.receive_data(data or None)
        for event in self._connection.events():
            match event:
                case AcceptConnection():
                    self._accepted = True
                case RejectConnection():
                    raise RefusedError(event.status_code)
                case Ping():
                    self._send(event.response())
                case CloseConnection():
                    self.closed = event.code
                    return
                case BytesMessage() | TextMessage():
                    self._parts.append(event.data if isinstance(event.data, str) else bytes(event.data))
                    if event.message_finished:
                        self._arrived.append(type(self._parts[0])().join(self._parts))  # type: ignore[arg-type]
                        self._parts = []
        if not data:
            self.closed = self.closed or 1006


class BoardSocket:
    """The link's frames over a page's WebSocket, sorted into frames and words."""

    def __init__(self, socket: WebSocket, meanwhile: Callable[[], None] | None = None) -> None:
        """`meanwhile` is done again and again while a message is waited for: it lets the board live."""
        self.socket = socket
        self._meanwhile = meanwhile
        self.words: list[dict[str, Any]] = []
        self.frames: list[Frame] = []
        self.raw = b""
        self._decoder = FrameDecoder()
        self._sequence = 0

    def ask(self, request: Message) -> int:
        """Send a request; its sequence number."""
        self._sequence = self._sequence % 255 + 1
        self.socket.say(encode_frame(request.TYPE, self._sequence, request.pack()))
        return self._sequence

    def hear(self) -> None:
        """Take one message."""
        message = self.socket.take(self._meanwhile)
        if isinstance(message, str):
            self.words.append(json.loads(message))
        else:
            self.raw += message
            self.frames += self._decoder.feed(message)

    def word(self, kind: str, **holds: object) -> dict[str, Any]:
        """The next message of a kind that holds this; earlier words are forgotten."""
        while True:
            while self.words:
                word = self.words.pop(0)
                if word["kind"] == kind and holds.items() <= word.items():
                    return word
            self.hear()

    def frame(self, type: int, seq: int | None = None) -> Frame:
        """The next frame of a type; earlier frames are forgotten."""
        while True:
            while self.frames:
                frame = self.frames.pop(0)
                if frame.type == type and seq in (None, frame.seq):
                    return frame
            self.hear()
