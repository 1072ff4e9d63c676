"""The host's end of the serial line: a pseudo-terminal that behaves like the USB port of an Arduino.

An Arduino resets when DTR rises: when its port is opened, unless whoever had it before switched HUPCL off, and so left
DTR up. A pseudo-terminal has no modem lines, so inotify on its path watches for opening and closing. It cannot see that
avrdude lowers and raises DTR by itself; a new speed on a port whose DTR was left up is taken for that. The bench keeps
one descriptor of its own open, so that the port outlives its users.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import fcntl
import os
import select
import struct
import termios
import tty
from collections.abc import Sequence
from pathlib import Path

from greywhale.base.errors import UserError, os_reason

IN_OPEN = 0x20
IN_CLOSE = 0x08 | 0x10
EVENT = struct.Struct("iIII")  # struct inotify_event, without a name: the watch is on a file
TCGETS2 = 0x802C542A  # tells any speed, where tcgetattr knows the classic ones only
CFLAG = 2  # place of the control flags in what termios returns
SPEED_OFFSET = 40  # c_ospeed in struct termios2
# Linux keeps so much of a real port for a program that does not come to read; of a pseudo-terminal it keeps a fifth.
KEPT_BYTES = 65536


class SerialPort:
    """One pty: who has it open, at which speed, and the bytes both ways."""

    def __init__(self, links: Sequence[Path] = ()) -> None:
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        flags = termios.tcgetattr(self._slave)
        flags[CFLAG] |= termios.HUPCL  # as serial ports have it, unlike pseudo-terminals
        termios.tcsetattr(self._slave, termios.TCSANOW, flags)
        os.set_blocking(self._master, False)
        self.path = os.ttyname(self._slave)
        self._notify = _watch(self.path)
        self._users = 0
        self._left_up = False  # DTR, by the last user, or for the user there is
        self._speed = self.baud()
        self._unseen = 0  # bytes written since the host was last known to have read all
        self._kept = bytearray()  # bytes that the pseudo-terminal has no room for
        self._links: list[Path] = []
        try:
            for link in links:
                self._make_link(link)
                self._links.append(link)
        except UserError:
            self.close()
            raise

    def poll(self) -> bool:
        """Take note of opens and closes since the last call; true if DTR rose."""
        speed, self._speed = self._speed, self.baud()
        opened = self._note_users()
        if self._users and self._left_up and self._speed != speed:
            opened, self._left_up = True, False
        return opened

    def _note_users(self) -> bool:
        try:
            events = os.read(self._notify, 4096)
        except BlockingIOError:
            return False
        opened = False
        for offset in range(0, len(events), EVENT.size):
            _, mask, _, _ = EVENT.unpack_from(events, offset)
            if mask & IN_OPEN:
                opened |= self._users == 0 and not self._left_up
                self._users += 1
            elif mask & IN_CLOSE:
                self._users = max(0, self._users - 1)
                if self._users == 0:
                    self._left_up = not termios.tcgetattr(self._slave)[CFLAG] & termios.HUPCL
        return opened

    @property
    def connected(self) -> bool:
        return self._users > 0

    def baud(self) -> float:
        """The speed the host has set."""
        settings = fcntl.ioctl(self._slave, TCGETS2, bytes(44))
        return float(struct.unpack_from("I", settings, SPEED_OFFSET)[0])

    def read(self) -> bytes:
        """Bytes that the host has written."""
        try:
            return os.read(self._master, 4096)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> int:
        """Hand `data`, and what is kept, to the host. Bytes for which there is no room are lost. Returns how many of
        `data` fitted.
        """
        fitted = min(len(data), KEPT_BYTES - len(self._kept))
        self._kept += data[:fitted]
        self._unseen += fitted
        with contextlib.suppress(BlockingIOError):
            while self._kept:
                del self._kept[: os.write(self._master, self._kept)]
        return fitted

    def unread(self) -> int:
        """The number of bytes that lie ready for the host; 0 only if it has read everything that was written."""
        # The kernel carries bytes to the host's side in its own time. Looking for them makes it do so at once.
        select.select([self._slave], [], [], 0)
        count: int = struct.unpack("i", fcntl.ioctl(self._slave, termios.FIONREAD, bytes(4)))[0]
        return count

    def backlog(self, limit: int) -> int:
        """An upper bound of the bytes that the host has not read; exact enough to compare it with `limit`."""
        if self._unseen > limit and not self._kept and self.unread() == 0:
            self._unseen = 0
        return self._unseen

    def discard_unread(self) -> None:
        self._kept.clear()
        while self.unread():
            termios.tcflush(self._slave, termios.TCIFLUSH)
        self._unseen = 0

    def close(self) -> None:
        for link in self._links:
            if link.is_symlink() and os.readlink(link) == self.path:
                link.unlink()
        for descriptor in (self._notify, self._slave, self._master):
            os.close(descriptor)

    def _make_link(self, link: Path) -> None:
        if link.exists() and not link.is_symlink():
            raise UserError(f"{link}: exists and is not a link; choose another name for the port.", 2)
        partial = link.with_name(f".{link.name}.{os.getpid()}")
        try:
            partial.symlink_to(self.path)
            partial.replace(link)
        except OSError as error:
            raise UserError(f"{link}: the link to the port cannot be made: {os_reason(error)}.") from None


def _watch(path: str) -> int:
    """An inotify descriptor that tells each open and close of `path`."""
    libc = ctypes.CDLL(None, use_errno=True)
    descriptor: int = libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
    if descriptor < 0 or libc.inotify_add_watch(descriptor, os.fsencode(path), IN_OPEN | IN_CLOSE) < 0:
        number = ctypes.get_errno() or errno.ENOSYS
        raise UserError(
            f"{path}: cannot be watched (inotify: {os.strerror(number).lower()}); raise fs.inotify.max_user_instances."
        )
    return descriptor
