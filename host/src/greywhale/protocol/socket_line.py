"""A line to a board behind a TCP port, such as a bench that listens at socket://127.0.0.1:5000: its bytes as they are.

There is no DTR line that could stay up, so each connection restarts the board; nor is there a speed.
"""

from __future__ import annotations

import select
import socket
import threading
import time
from urllib.parse import urlsplit

from greywhale.base.errors import BadUsage, UserError, os_reason
from greywhale.protocol.transport import READ_WAIT_S, PortLostError

PREFIX = "socket://"  # as pyserial has it
PIECE_BYTES = 65536  # read at once


class SocketLine:
    """A line over TCP that serves a device like a Transport. Every failure is a UserError that names the port."""

    restarted = True
    heard = False  # a byte from the board
    write_wait_s: float | None = 1.0

    def __init__(self, port: str, connection: socket.socket | None = None) -> None:
        """Connect, or take a connection that there is."""
        self._port = port
        self._connection = connection or _connect(port)
        self._writing = threading.Lock()  # two threads never mix their frames

    def read(self) -> bytes:
        """Return what has arrived; wait a moment when nothing has, and then return perhaps nothing."""
        if not select.select([self._connection], [], [], READ_WAIT_S)[0]:
            return b""
        try:
            data = self._connection.recv(PIECE_BYTES)
        except OSError:
            data = b""
        if not data:
            raise self._lost()
        self.heard = True
        return data

    def write(self, data: bytes) -> None:
        try:
            with self._writing:
                self._connection.settimeout(self.write_wait_s)
                self._connection.sendall(data)
        except OSError:
            raise self._lost() from None

    def close(self) -> None:
        self._connection.close()

    def clock(self) -> float:
        return time.monotonic()

    def wait(self, seconds: float) -> None:
        time.sleep(seconds)

    def _lost(self) -> UserError:
        if self.heard:
            return PortLostError(self._port)
        return UserError(f"{self._port}: whoever listens there hung up at once; it may serve another program already.")


def address_of(port: str) -> tuple[str, int]:
    """Host and number of a port such as socket://127.0.0.1:5000."""
    try:
        parts = urlsplit(port)
        if parts.hostname and parts.port and parts.path in ("", "/") and "@" not in parts.netloc:
            return parts.hostname, parts.port
    except ValueError:
        pass
    raise BadUsage(f"{port}: this is no TCP port; write it as {PREFIX}127.0.0.1:5000.")


def _connect(port: str) -> socket.socket:
    try:
        connection = socket.create_connection(address_of(port), timeout=5.0)
    except OSError as error:
        raise UserError(
            f"{port}: no connection: {os_reason(error)}; start a bench there (`greywhale sim --listen`), or name "
            "another port."
        ) from None
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return connection
