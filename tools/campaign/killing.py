"""Runs a verb of the command line in a child process that is killed (SIGKILL) at a chosen moment.

The parent has imported everything, so a child costs a fork. A moment is a time since the start, or the k-th change that
the verb makes: a file created, written, brought to the disk, named, renamed or removed, a folder made, bytes sent to a
board. A killed write has written a share of its bytes. A verb that computes for long before it changes anything of
worth is `Held` there: the children begin at that point, so that it computes once for all of them.
"""

from __future__ import annotations

import builtins
import contextlib
import io
import json
import os
import signal
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO, Any, NoReturn, Self

from greywhale.board.device import Device
from greywhale.cli import entry

_CHANGES = ("link", "replace", "rename", "unlink", "remove", "rmdir", "mkdir", "truncate", "ftruncate", "fsync")
_CREATES = os.O_CREAT | os.O_TMPFILE & ~os.O_DIRECTORY
_BROKEN = 70
_MARK = "GREYWHALE_KILLED_IN"  # in the environment of every program that a child starts
_ENDS_WITHIN_S = 60.0  # a build goes on to its end
# What the harness itself opens is no change.
_OPEN = builtins.open


@dataclass(frozen=True)
class Moment:
    """When to kill: `after_s` of run time, or at change number `change` (from 0), a write after this share of it."""

    after_s: float | None = None
    change: int | None = None
    share: float = 0.0


NEVER = Moment()


@dataclass(frozen=True)
class Ending:
    """How a child ended: its exit code, None where it was killed; how long it took, how many changes a whole one made,
    and what it said.
    """

    code: int | None
    seconds: float
    changes: int
    said: str


def run(arguments: Sequence[str], folder: Path, moment: Moment = NEVER, quick: bool = True) -> Ending:
    """Run a verb in a folder, to its end or to the moment of its death. `quick` waits for no bootloader."""
    with _OPEN(f"{folder}.said", "w+b") as said:

        def be(tell: IO[bytes]) -> int:
            os.chdir(folder)
            os.environ[_MARK] = str(folder)
            _speak_into(said)
            changes = Changes(moment)
            code = _do(arguments, quick, changes)
            tell.write(str(changes.count).encode())
            return code

        ending: Ending = _end(be, moment, said)
        return ending


def wait_for_programs(folder: Path) -> list[str]:
    """The programs that a child in this folder has started and that do not end within a minute of its death."""
    deadline = time.monotonic() + _ENDS_WITHIN_S
    while (left := _programs(folder)) and time.monotonic() < deadline:
        time.sleep(0.1)
    return left


def _programs(folder: Path) -> list[str]:
    """Their command lines."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):  # it has ended meanwhile, or is another user's
            if f"{_MARK}={folder}".encode() in (process / "environ").read_bytes().split(b"\0"):
                found.append((process / "cmdline").read_bytes().replace(b"\0", b" ").decode("utf-8", "replace").strip())
    return found


class Held:
    """A verb that runs in a process of its own until `done` changes are made, and goes on in children. A context.

    What it writes must lie in the folder in which it runs. The children count their changes from there.
    """

    def __init__(self, arguments: Sequence[str], folder: Path, done: int) -> None:
        self._arguments, self._folder, self._done = arguments, folder, done

    def __enter__(self) -> Self:
        (asked, asks), (told, tells) = os.pipe(), os.pipe()
        self._holder = os.fork()
        if self._holder == 0:
            try:
                os.close(asks)
                os.close(told)
                self._hold(open(asked, "rb"), open(tells, "wb", 0))
            finally:
                os._exit(_BROKEN)
        os.close(asked)
        os.close(tells)
        self._asks, self._told = open(asks, "wb", 0), open(told, "rb")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._asks.close()
        self._told.close()
        os.waitpid(self._holder, 0)

    def run(self, folder: Path, moment: Moment = NEVER) -> Ending:
        """As `run` does, in this folder and from where the verb is held."""
        self._asks.write(json.dumps([str(folder), moment.after_s, moment.change, moment.share]).encode() + b"\n")
        answer = self._told.readline()
        if not answer:
            raise RuntimeError(f"{self._arguments[0]} ended within its first {self._done} changes")
        return Ending(*json.loads(answer))

    def _hold(self, asked: IO[bytes], tell: IO[bytes]) -> None:
        child_tells: list[IO[bytes]] = []

        def choose() -> Moment:
            """Serve in the holder; return in each child."""
            for line in asked:
                folder, *moment = json.loads(line)
                chosen = Moment(*moment)
                with _OPEN(f"{folder}.said", "w+b") as said:

                    def be(tells: IO[bytes], folder: str = folder, said: IO[bytes] = said) -> None:
                        os.chdir(folder)
                        _speak_into(said)
                        child_tells.append(tells)

                    ending = _end(be, chosen, said)
                    if ending is None:
                        return chosen
                    tell.write(json.dumps([ending.code, ending.seconds, ending.changes, ending.said]).encode() + b"\n")
            os._exit(0)

        os.chdir(self._folder)
        changes = Changes(NEVER, choose, self._done)
        code = _do(self._arguments, True, changes)
        if child_tells:
            child_tells[0].write(str(changes.count).encode())
            os._exit(code)


def _end(be: Callable[[IO[bytes]], int | None], moment: Moment, said: IO[bytes]) -> Any:
    """Fork, and tell the Ending of the child. It does `be` and ends with its code; if that is None, it returns None."""
    told, tells = os.pipe()
    begun = time.monotonic()
    child = os.fork()
    if child == 0:
        code: int | None = _BROKEN
        try:
            os.close(told)
            code = be(_OPEN(tells, "wb", 0))
        finally:
            if code is not None:
                os._exit(code)
        return None
    os.close(tells)
    if moment.after_s is not None:
        time.sleep(max(0.0, begun + moment.after_s - time.monotonic()))
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    seconds = time.monotonic() - begun
    with _OPEN(told, "rb") as pipe:
        count = int(pipe.read() or 0)
    said.seek(0)
    code = None if os.WIFSIGNALED(status) else os.waitstatus_to_exitcode(status)
    return Ending(code, seconds, count, said.read().decode("utf-8", "replace"))


def _speak_into(said: IO[bytes]) -> None:
    for stream in (1, 2):
        os.dup2(said.fileno(), stream)


def _do(arguments: Sequence[str], quick: bool, changes: Changes) -> int:
    if quick:
        setattr(Device.__init__, "__defaults__", (0.0, 0.5))  # noqa: B010 (mypy forbids the plain assignment)
    changes.watch()
    return entry.run(arguments)


class Changes:
    """Counts the changes that this process makes, and kills it at one of them.

    When `done` changes are made, `choose` may choose the moment just before the next, from which on it counts anew.
    """

    def __init__(self, moment: Moment, choose: Callable[[], Moment] | None = None, done: int = 0) -> None:
        self.count = 0
        self._moment, self._choose, self._done = moment, choose, done

    def happens(self) -> bool:
        """Count a change; whether it is the last."""
        if self._choose is not None and self.count == self._done:
            choose, self._choose = self._choose, None
            self._moment, self.count = choose(), 0
        self.count += 1
        return self._moment.change == self.count - 1

    def portion(self, data: Any) -> memoryview:
        """What the last write still writes."""
        view = memoryview(data).cast("B")
        return view[: round(self._moment.share * len(view))]

    def watch(self) -> None:
        """Put a look in front of every function that changes something."""
        open_number, write = os.open, os.write

        def watched_open(path: Any, flags: int, *rest: Any, **named: Any) -> int:
            if flags & _CREATES and self.happens():
                die()
            return open_number(path, flags, *rest, **named)

        def watched_write(descriptor: int, data: Any) -> int:
            if not self.happens():
                return write(descriptor, data)
            write(descriptor, self.portion(data))
            die()

        for name in _CHANGES:
            setattr(os, name, self._watched(getattr(os, name)))
        setattr(os, "open", watched_open)  # noqa: B010
        setattr(os, "write", watched_write)  # noqa: B010
        setattr(io, "open", self._open)  # noqa: B010
        setattr(builtins, "open", self._open)  # noqa: B010

    def _watched(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def watched(*arguments: Any, **named: Any) -> Any:
            if self.happens():
                die()
            return function(*arguments, **named)

        return watched

    def _open(self, file: Any, mode: str = "r", buffering: int = -1, *rest: Any, **named: Any) -> Any:
        """The built-in `open`, of which every write that reaches the system is watched."""
        if not set(mode) & set("wax+"):
            return _OPEN(file, mode, buffering, *rest, **named)
        if not isinstance(file, int) and self.happens():
            die()
        raw = _WatchedFile(
            file, mode.replace("b", "").replace("t", ""), named.get("closefd", True), named.get("opener")
        )
        raw.changes = self
        if "b" in mode and buffering == 0:
            return raw
        binary = io.BufferedRandom(raw) if "+" in mode else io.BufferedWriter(raw)
        return binary if "b" in mode else io.TextIOWrapper(binary, named.get("encoding"))


class _WatchedFile(io.FileIO):
    changes: Changes

    def write(self, data: Any) -> int:
        if not self.changes.happens():
            return super().write(data)
        super().write(self.changes.portion(data))
        die()


def die() -> NoReturn:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError("a killed process goes on")
