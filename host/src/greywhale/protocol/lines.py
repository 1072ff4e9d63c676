"""Opens a line to a board by the name of its port: one of the system's, a TCP port, or a line that needs no port."""

from __future__ import annotations

from greywhale.base import system
from greywhale.protocol.socket_line import PREFIX, SocketLine
from greywhale.protocol.transport import BAUD, LENT, LINES, Line, Transport


def open_line(port: str, restart: bool = True, baud: int = BAUD) -> Line:
    """Open the port, with a `restart` of the board or, if that can be, without: the line tells whether it restarted."""
    opened = LENT.get(port) or LINES.get(port)
    if opened is not None:
        return opened(restart, baud)
    return SocketLine(port) if port.startswith(PREFIX) else Transport(port, restart, baud)


def device_of(port: str) -> str | None:
    """The key that all names of a port share: the system's device, or the TCP port; None where there is neither."""
    return port if port.startswith(PREFIX) else system.device_of(port)
