"""Work in a process of its own, while this one leads an arm: neither samples nor lease ever wait for it.

A thread would not do. It shares this process's interpreter, which every reading of the port then asks for again.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from functools import partial
from types import ModuleType
from typing import Any, Generic, Protocol, TypeVar

from greywhale.base.errors import UserError
from greywhale.base.study.workers import LocalWorkers, SerialWorkers, left_at_once
from greywhale.base.types import NotedProgress

Result = TypeVar("Result")


class Line(Protocol):
    """One end of a line between two processes, whatever the system makes it of."""

    def send(self, obj: Any, /) -> None: ...
    def recv(self) -> Any: ...
    def poll(self, timeout: float = 0.0, /) -> bool: ...


_lines: list[Line] = []  # in the process of the work: the one to whoever waits for it


class SideJob(Generic[Result]):
    """Work that tells its progress, which nobody sees until somebody waits for the result."""

    def __init__(self, number: int, future: Future[Result], line: Line, report: NotedProgress) -> None:
        self._number = number
        self._future = future
        self._line = line
        self._report = report

    def result(self) -> Result:
        """Return the work's result, or raise its error."""
        with contextlib.suppress(OSError):  # its process has ended
            self._line.send(self._number)
        while not self._future.done():
            if self._told(0.05):  # so often a report, the end or Ctrl-C is looked for
                self._report(*self._line.recv())
        while self._told(0.0):
            self._line.recv()
        try:
            return self._future.result()
        except BrokenExecutor:
            raise UserError(
                "the process that learns beside the motion was ended, perhaps because memory was short; try again."
            ) from None

    def _told(self, wait_s: float) -> bool:
        with contextlib.suppress(OSError):
            return self._line.poll(wait_s)
        return False


class SideJobs:
    """Begins jobs, one after the other. What a job is and gives must be fit to be pickled."""

    def __init__(self, executor: Executor, line: Line, report: NotedProgress) -> None:
        self._executor = executor
        self._line = line
        self._report = report
        self._begun = 0

    def begin(self, work: Callable[[NotedProgress], Result]) -> SideJob[Result]:
        self._begun += 1
        with _main_left_out():
            future = self._executor.submit(_work, self._begun, work)
        return SideJob(self._begun, future, self._line, self._report)


@contextlib.contextmanager
def _main_left_out() -> Iterator[None]:
    """A process that starts meanwhile does not run the caller's script again, which may well lead an arm at once."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


@contextlib.contextmanager
def side_jobs(report: NotedProgress, here: bool = False) -> Iterator[SideJobs]:
    """One process for all jobs; leaving it ends them at once, wherever they are. `here`: no process, for tests."""
    ours, theirs = multiprocessing.Pipe()
    workers = SerialWorkers() if here else LocalWorkers(1, partial(_take, theirs))
    with ours, theirs, left_at_once(workers) as executor:
        yield SideJobs(executor, ours, report)


def _take(line: Line) -> None:
    _lines.append(line)


def _work(number: int, work: Callable[[NotedProgress], Result]) -> Result:
    awaited = False

    def tell(what: str, fraction: float, note: str = "") -> None:
        nonlocal awaited
        for line in _lines:
            while not awaited and line.poll():
                awaited = line.recv() == number
            if awaited:
                line.send((what, fraction, note))

    return work(tell)
