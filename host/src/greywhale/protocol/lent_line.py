"""A line to a board that another process holds and lends: its frames come and go over a socket.

Whoever lends it has greeted the board and keeps its port. So to open it restarts nothing, and its end is a lost port.
"""

from __future__ import annotations

import contextlib
import select
import socket
import time

from greywhale.protocol.transport import LENT, READ_WAIT_S, Line, PortLostError

_PIECE = 65536


class LentLine:
    """What a Transport is to a device; it may be opened again and again."""

    restarted = False

    def __init__(self, port: str, connection: socket.socket) -> None:
        self._port = port
        self._connection = connection
        connection.setblocking(False)
        with contextlib.suppress(BlockingIOError):  # what was said before is nobody's
            while connection.recv(_PIECE):
                pass

    def read(self) -> bytes:
        if not select.select([self._connection], [], [], READ_WAIT_S)[0]:
            return b""
        try:
            data = self._connection.recv(_PIECE)
        except OSError:
            data = b""
        if not data:
            raise PortLostError(self._port)
        return data

    def write(self, data: bytes) -> None:
        try:
            self._connection.setblocking(True)
            self._connection.sendall(data)
        except OSError:
            raise PortLostError(self._port) from None
        finally:
            self._connection.setblocking(False)

    def close(self) -> None:
        """Whoever lent it keeps it."""

    def clock(self) -> float:
        return time.monotonic()

    def wait(self, seconds: float) -> None:
        time.sleep(seconds)


def lend(port: str, connection: socket.socket) -> None:
    """Whoever opens the port in this process from now on gets the lent line."""

    def open_lent(restart: bool, baud: int) -> Line:
        return LentLine(port, connection)

    LENT[port] = open_lent
