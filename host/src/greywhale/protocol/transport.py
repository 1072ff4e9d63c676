"""The serial port as bytes: opened exclusively at 1 Mbaud; every failure of it becomes one sentence."""

from __future__ import annotations

import errno
import os
import threading

import serial

from greywhale.errors import UserError, os_reason

BAUD = 1_000_000

# How long a read waits for the first byte. Short, so that deadlines are kept; long enough not to spin.
_READ_WAIT_S = 0.02
_WRITE_WAIT_S = 1.0


class Transport:
    """An open port; every failure of it is a UserError that names it."""

    def __init__(self, port: str) -> None:
        self.port = port
        self._serial = open_serial(port, BAUD, _READ_WAIT_S)
        self._writing = threading.Lock()  # two threads never mix their frames

    def read(self) -> bytes:
        """Return what has arrived; wait a moment when nothing has, and then return perhaps nothing."""
        try:
            return bytes(self._serial.read(self._serial.in_waiting or 1))
        except (OSError, TypeError) as error:  # pyserial reads from a port closed under it as a TypeError
            raise self._gone(error) from None

    def write(self, data: bytes) -> None:
        try:
            with self._writing:
                self._serial.write(data)
        except serial.SerialTimeoutException:
            raise UserError(
                f"{self.port}: the port takes no data; unplug the board, plug it in and try again."
            ) from None
        except (OSError, TypeError) as error:
            raise self._gone(error) from None

    def close(self) -> None:
        with self._writing:
            self._serial.close()

    def _gone(self, error: Exception) -> UserError:
        reason = os_reason(error) if isinstance(error, OSError) else "it was closed"
        return UserError(
            f"{self.port}: the port went away in the middle ({reason.rstrip('.')}); check the cable and try again."
        )


def open_serial(port: str, baud: int, read_wait_s: float) -> serial.Serial:
    """Open the port for this process alone."""
    if not os.path.exists(port):
        raise UserError(f"{port}: there is no such port; `greywhale ports` lists those there are.")
    try:
        return serial.Serial(port, baud, timeout=read_wait_s, write_timeout=_WRITE_WAIT_S, exclusive=True)
    except ValueError as error:
        raise UserError(f"{port}: cannot be opened: {error}.") from None
    except OSError as error:
        raise UserError(_why_not_open(port, error)) from None


def _why_not_open(port: str, error: OSError) -> str:
    if error.errno in (errno.EBUSY, errno.EAGAIN, errno.EWOULDBLOCK):
        return f"{port}: the port is in use by another program; close that (a serial monitor?) and try again."
    if error.errno in (errno.EACCES, errno.EPERM):
        return (
            f"{port}: no permission to open the port; add yourself to its group "
            "(`sudo usermod -aG dialout $USER`) and log in again."
        )
    if error.errno in (errno.ENOENT, errno.ENODEV, errno.ENXIO):
        return f"{port}: there is no such port any more; `greywhale ports` lists those there are."
    if error.errno in (errno.ENOTTY, errno.EISDIR, errno.EINVAL) or error.errno is None:
        return f"{port}: this is not a serial port; `greywhale ports` lists those there are."
    return f"{port}: the port cannot be opened: {os_reason(error)}."
