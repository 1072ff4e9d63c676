"""Where operating systems differ, for all that needs no board: locks on files, and signals that end.

Linux is tried. Windows has neither `fcntl` nor the signal of a closed terminal. Verbs without a board get by with what
is here; a verb with one says that it needs another system (`greywhale.cli.entry`).
"""

from __future__ import annotations

import contextlib
import errno
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

NOT_ON_WINDOWS = ("fcntl", "termios", "tty")  # modules of Python for what meets a board, or stands for one

fcntl: Any  # a system has one of both
msvcrt: Any
try:
    import fcntl
except ImportError:
    import msvcrt

    fcntl = None

HANG_UP: signal.Signals | None = getattr(signal, "SIGHUP", None)  # of a terminal that is closed
ENDING = (signal.SIGINT, signal.SIGTERM, *([HANG_UP] if HANG_UP is not None else []))
RENAMES_OPEN_FILES = fcntl is not None
# How a file is opened: as it is on the disk, and not where a link leads.
_PLAIN = getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
_FAR = 1 << 40  # Windows keeps others from reading what is locked, and no file of ours is so long


def open_plain(path: Path, flags: int) -> int:
    """A descriptor of a file that is no link; no child inherits it."""
    return os.open(path, flags | _PLAIN, 0o666)


def lock(descriptor: int, wait: bool = False) -> None:
    """Hold an open file until it is closed or this process ends, however it ends: BlockingIOError where another process
    holds it, another OSError where a file system knows no locks.
    """
    if fcntl is not None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        return
    place = os.lseek(descriptor, 0, os.SEEK_CUR)
    os.lseek(descriptor, _FAR, os.SEEK_SET)
    try:
        msvcrt.locking(descriptor, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
    except PermissionError as error:
        raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN)) from error
    finally:
        os.lseek(descriptor, place, os.SEEK_SET)


@contextlib.contextmanager
def no_interrupts_for_children() -> Iterator[None]:
    """Programs that are started meanwhile do not hear Ctrl-C, where a system can tell them so."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def hear_interrupts() -> None:
    """End what `no_interrupts_for_children` began in the process that started this one."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
