"""The host's end of the serial line as a TCP port, for systems without pseudo-terminals, containers, other machines.

It carries the bytes as they are. It has no speed, and each connection is a DTR that rises.
"""

from __future__ import annotations

import socket

from greywhale.base.errors import BadUsage, UserError, os_reason
from greywhale.protocol.socket_line import PREFIX, address_of
from greywhale_sim.line import ANY_BAUD

LOOPBACK = "127.0.0.1"
PIECE_BYTES = 4096
KEPT_BYTES = 65536  # for a host that does not come to read, beside what the system keeps


class SocketPort:
    """Listens at PORT or HOST:PORT, 0 for any free one, for one program at a time."""

    def __init__(self, listen: str) -> None:
        name = listen if ":" in listen else f"{LOOPBACK}:{listen}"
        try:
            host, number = (name[:-2], 0) if name.endswith(":0") else address_of(PREFIX + name)
            self._listener = socket.create_server((host, number))
        except BadUsage:
            raise BadUsage(f"--listen {listen}: say PORT or HOST:PORT, such as 5000 or {LOOPBACK}:5000.") from None
        except OSError as error:
            raise UserError(f"--listen {listen}: cannot listen there: {os_reason(error)}.") from None
        self._listener.setblocking(False)
        self.path = f"{PREFIX}{host}:{self._listener.getsockname()[1]}"
        self._user: socket.socket | None = None
        self._kept = bytearray()

    @property
    def connected(self) -> bool:
        return self._user is not None

    def poll(self) -> bool:
        """Take a program that has come; true if there is a new one."""
        try:
            connection, _ = self._listener.accept()
        except OSError:  # nobody, or somebody who has gone again
            return False
        if self._user is not None:
            connection.close()
            return False
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._user = connection
        return True

    def baud(self) -> float:
        """It has none."""
        return ANY_BAUD

    def read(self) -> bytes:
        """Bytes that the host has written."""
        if self._user is None:
            return b""
        try:
            data = self._user.recv(PIECE_BYTES)
        except BlockingIOError:
            return b""
        except OSError:
            data = b""
        if not data:
            self._hang_up()
        return data

    def write(self, data: bytes) -> int:
        """Hand `data`, and what is kept, to the host. Bytes for which there is no room are lost. Returns how many of
        `data` fitted.
        """
        fitted = min(len(data), KEPT_BYTES - len(self._kept))
        self._kept += data[:fitted]
        while self._user is not None and self._kept:
            try:
                del self._kept[: self._user.send(self._kept)]
            except BlockingIOError:
                break
            except OSError:
                self._hang_up()
        return fitted

    def backlog(self, limit: int) -> int:
        """The bytes that the system has not taken; what lies between it and the host cannot be seen."""
        return len(self._kept)

    def discard_unread(self) -> None:
        self._kept.clear()

    def close(self) -> None:
        self._hang_up()
        self._listener.close()

    def _hang_up(self) -> None:
        if self._user is not None:
            self._user.close()
            self._user = None
