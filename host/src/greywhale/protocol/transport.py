"""The serial port as bytes: opened exclusively, mostly at 1 Mbaud; every failure of it becomes one sentence.

An Arduino restarts when its DTR line rises. The system raises DTR when a port is opened, and lets it fall when the port
is closed, unless the terminal's flag HUPCL is off. A session switches that flag off at its end. So the next one can
open the port without a restart, or lets DTR fall first where it wants one.
"""

from __future__ import annotations

import errno
import threading
import time
from collections.abc import Callable
from typing import Protocol

import serial

from greywhale.base import system
from greywhale.base.errors import UserError, os_reason
from greywhale.protocol.holder import holder_of, meddler, second_user_of

BAUD = 1_000_000

# How long a read waits for the first byte. Short, so that deadlines are kept; long enough not to spin.
READ_WAIT_S = 0.02
_BUSY = (errno.EBUSY, errno.EAGAIN, errno.EWOULDBLOCK)
_HAS_OPEN, _READS = "has the port open too", "reads from the port too"


class PortLostError(UserError):
    """The port went away: an unplugged cable, or the end of a bench."""

    def __init__(self, port: str) -> None:
        super().__init__(f"{port}: the port went away in the middle; check the cable and try again.")


class PortBusyError(UserError):
    """Another program has the port."""

    def __init__(self, port: str) -> None:
        holder = holder_of(port)
        by, what = ("another program", " (a serial monitor?)") if holder is None else (holder, "")
        super().__init__(f"{port}: the port is in use by {by}; close that{what} and try again.")


class PortDisturbedError(UserError):
    """The port is there, but another program reads from it, or has set it in another way."""

    def __init__(self, port: str, what: str) -> None:
        user = second_user_of(port)
        if user is not None:
            who, remedy = f"another program, {user},", "close that program"
        else:
            who, remedy = "another program", meddler(port) or "close what else may use the port"
        super().__init__(f"{port}: {who} {what}, and two cannot share a port; {remedy}, and try again.")


class Line(Protocol):
    """The interface of a line to a board. Its `clock` (s) times what the host waits for, and `wait` (s) waits."""

    restarted: bool

    def read(self) -> bytes: ...
    def write(self, data: bytes) -> None: ...
    def close(self) -> None: ...
    def clock(self) -> float: ...
    def wait(self, seconds: float) -> None: ...


# Lines that are no ports of the system, such as to a bench in this process, by the name that stands for the port. Each
# is opened with or without a restart of the board, at a speed.
LINES: dict[str, Callable[[bool, int], Line]] = {}
# Ports of the system that another process holds and lends to this one (lent_line.py).
LENT: dict[str, Callable[[bool, int], Line]] = {}


def disturbance(line: Line) -> PortDisturbedError | None:
    """Another program's harm to a line, as far as the system tells; None where nothing is known of that kind."""
    return line.disturbance() if isinstance(line, Transport) else None


class Transport:
    """An open port; every failure of it is a UserError that names it."""

    def __init__(self, port: str, restart: bool = True, baud: int = BAUD) -> None:
        """Open the port, with a `restart` of the board or, if that can be, without: `restarted` tells."""
        self.port = port
        self._to_firmware = baud == BAUD
        self._serial = _open_serial(port, baud, restart)
        self.restarted = restart or not system.keeps_dtr(self._serial)
        self._settings = system.line_settings(self._serial)
        self._writing = threading.Lock()  # two threads never mix their frames

    def read(self) -> bytes:
        """Return what has arrived; wait a moment when nothing has, and then return perhaps nothing."""
        try:
            return bytes(self._serial.read(self._serial.in_waiting or 1))
        except (OSError, TypeError):  # pyserial reads from a port closed under it as a TypeError
            raise self._lost() from None

    def write(self, data: bytes) -> None:
        try:
            with self._writing:
                self._serial.write(data)
        except serial.SerialTimeoutException:
            raise UserError(
                f"{self.port}: the port takes no data; unplug the board, plug it in and try again."
            ) from None
        except (OSError, TypeError):
            raise self._lost() from None

    def disturbance(self) -> PortDisturbedError | None:
        """Another program's harm to the port, as far as the system tells."""
        if changed := self._changed():
            return changed
        return None if second_user_of(self.port) is None else PortDisturbedError(self.port, _HAS_OPEN)

    def clock(self) -> float:
        """This machine's own."""
        return time.monotonic()

    def wait(self, seconds: float) -> None:
        time.sleep(seconds)

    def close(self) -> None:
        with self._writing:
            if self._serial.is_open and self._to_firmware:
                system.keep_dtr(self._serial, True)
            _close(self._serial)

    def _lost(self) -> UserError:
        """The error of a port that fails: it has gone, or somebody else takes its bytes."""
        if system.line_settings(self._serial) is None:
            return PortLostError(self.port)
        return self._changed() or PortDisturbedError(self.port, _READS)

    def _changed(self) -> PortDisturbedError | None:
        """Another program's settings on a port that is still there."""
        settings = system.line_settings(self._serial)
        if settings is None or self._settings is None or settings == self._settings:
            return None
        before, now = system.speed_in(self._settings), system.speed_in(settings)
        if before == now:
            return PortDisturbedError(self.port, "changed the settings of the port")
        speed = "another speed" if now is None else f"{now} baud"
        return PortDisturbedError(self.port, f"set the port to {speed} instead of {before}")


def _open_serial(port: str, baud: int, restart: bool) -> serial.Serial:
    """Open the port for this process alone; with `restart`, the board behind it restarts for sure."""
    line = _open(port, baud)
    if restart and system.keeps_dtr(line):
        system.keep_dtr(line, False)
        _close(line)
        time.sleep(0.05)  # a board's reset line needs some 2 ms
        line = _open(port, baud)
    return line


def _open(port: str, baud: int) -> serial.Serial:
    if not system.exists(port):
        raise UserError(f"{port}: there is no such port; `greywhale ports` lists those there are.")
    try:
        if system.is_own_terminal(port):
            raise UserError(f"{port}: this is a terminal, not a board's port; `greywhale ports` lists those there are.")
        line = serial.Serial(port, baud, timeout=READ_WAIT_S, write_timeout=1.0, exclusive=True)
    except ValueError as error:
        raise UserError(f"{port}: cannot be opened: {error}.") from None
    except OSError as error:
        if system.open_errno(error) in _BUSY:
            raise PortBusyError(port) from None
        raise UserError(_why_not_open(port, error)) from None
    system.keep_others_out(line, True)
    return line


def _close(line: serial.Serial) -> None:
    if line.is_open:
        system.keep_others_out(line, False)
    line.close()


def _why_not_open(port: str, error: OSError) -> str:
    number = system.open_errno(error)
    if number in (errno.EACCES, errno.EPERM):
        return (
            f"{port}: no permission to open the port; add yourself to its group "
            "(`sudo usermod -aG dialout $USER`) and log in again."
        )
    if number in (errno.ENOENT, errno.ENODEV, errno.ENXIO):
        return f"{port}: there is no such port any more; `greywhale ports` lists those there are."
    if number in (errno.ENOTTY, errno.EISDIR, errno.EINVAL) or number is None:
        return f"{port}: this is not a serial port; `greywhale ports` lists those there are."
    return f"{port}: the port cannot be opened: {os_reason(error)}."
