"""A line to a board that another process holds and lends: its frames come and go over a socket.

Whoever lends it has greeted the board and keeps its port. So to open it restarts nothing, and its end is a lost port.
"""

from __future__ import annotations

import contextlib
import socket

from greywhale.protocol.socket_line import PIECE_BYTES, SocketLine
from greywhale.protocol.transport import LENT, Line


class LentLine(SocketLine):
    """It may be opened again and again."""

    restarted = False
    heard = True
    write_wait_s = None

    def __init__(self, port: str, connection: socket.socket) -> None:
        super().__init__(port, connection)
        connection.setblocking(False)
        with contextlib.suppress(BlockingIOError):  # what was said before is nobody's
            while connection.recv(PIECE_BYTES):
                pass

    def close(self) -> None:
        """Whoever lent it keeps it."""


def lend(port: str, connection: socket.socket) -> None:
    """Whoever opens the port in this process from now on gets the lent line."""

    def open_lent(restart: bool, baud: int) -> Line:
        return LentLine(port, connection)

    LENT[port] = open_lent
