"""Does some work in a forked child that is killed (SIGKILL) just before its k-th change to files, or to a board.

A change is a file created, written, brought to the disk, named, renamed or removed, a folder made, or bytes sent. A
write that is killed has written half of its bytes. The parent has imported everything, so a child costs a fork.
"""

from __future__ import annotations

import builtins
import io
import os
import signal
from collections.abc import Callable
from typing import Any, NoReturn

CHANGES = ("link", "replace", "rename", "unlink", "remove", "rmdir", "mkdir", "truncate", "ftruncate", "fsync")
CREATES = os.O_CREAT | os.O_TMPFILE & ~os.O_DIRECTORY
BROKEN = 70
OPEN = builtins.open


def count_changes(work: Callable[[], object]) -> int:
    """Do the work in a child, to its end: how many changes it makes."""
    count = _do(work, None)
    assert count is not None
    return count


def kill(work: Callable[[], object], change: int) -> None:
    """Do the work in a child that dies just before change number `change`, from 0."""
    assert _do(work, change) is None, "the work had ended before"


def _do(work: Callable[[], object], change: int | None) -> int | None:
    """The number of changes; None where the child was killed. What it prints is lost."""
    told, tell = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            silence = os.open(os.devnull, os.O_WRONLY)
            for stream in (1, 2):
                os.dup2(silence, stream)
            changes = _Changes(change, os.write)
            changes.watch()
            work()
            changes.write(tell, str(changes.count).encode())
            os._exit(0)
        finally:
            os._exit(BROKEN)
    os.close(tell)
    with open(told, "rb") as pipe:
        count = pipe.read()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return None
    assert os.waitstatus_to_exitcode(status) == 0, "the work failed"
    return int(count)


class _Changes:
    """Counts the changes that this process makes, and kills it at one of them."""

    def __init__(self, last: int | None, write: Callable[[int, Any], int]) -> None:
        self.count = 0
        self.write = write
        self._last = last

    def watch(self) -> None:
        """Put a look in front of every function that changes something."""
        create = os.open

        def watched_open(path: Any, flags: int, *rest: Any, **named: Any) -> int:
            if flags & CREATES:
                self._die_at_last()
            return create(path, flags, *rest, **named)

        def watched_write(descriptor: int, data: Any) -> int:
            if self.is_last():
                self.write(descriptor, _half(data))
                _die()
            return self.write(descriptor, data)

        for name in CHANGES:
            setattr(os, name, self._watched(getattr(os, name)))
        setattr(os, "open", watched_open)  # noqa: B010 (mypy forbids the plain assignment)
        setattr(os, "write", watched_write)  # noqa: B010
        setattr(io, "open", self._open)  # noqa: B010
        setattr(builtins, "open", self._open)  # noqa: B010

    def is_last(self) -> bool:
        """Count a change; whether the child dies at it."""
        self.count += 1
        return self._last == self.count - 1

    def _die_at_last(self) -> None:
        if self.is_last():
            _die()

    def _watched(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def watched(*arguments: Any, **named: Any) -> Any:
            self._die_at_last()
            return function(*arguments, **named)

        return watched

    def _open(self, file: Any, mode: str = "r", buffering: int = -1, *rest: Any, **named: Any) -> Any:
        """The built-in `open`, of which every write that reaches the system is watched."""
        if not set(mode) & set("wax+"):
            return OPEN(file, mode, buffering, *rest, **named)
        if not isinstance(file, int):
            self._die_at_last()
        raw = _WatchedFile(file, mode.replace("b", "").replace("t", ""), named.get("closefd", True))
        raw.changes = self
        if "b" in mode and buffering == 0:
            return raw
        binary = io.BufferedRandom(raw) if "+" in mode else io.BufferedWriter(raw)
        return binary if "b" in mode else io.TextIOWrapper(binary, named.get("encoding"))


class _WatchedFile(io.FileIO):
    changes: _Changes

    def write(self, data: Any) -> int:
        if not self.changes.is_last():
            return super().write(data)
        super().write(_half(data))
        _die()


def _half(data: Any) -> memoryview:
    view = memoryview(data).cast("B")
    return view[: len(view) // 2]


def _die() -> NoReturn:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError("a killed process goes on")
