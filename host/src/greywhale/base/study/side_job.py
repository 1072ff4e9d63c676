"""Work in a thread of its own, while the main thread has other things to do."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from threading import Event
from typing import Generic, TypeVar

from greywhale.base.closing import Closing
from greywhale.base.types import NotedProgress

Result = TypeVar("Result")
CTRL_C_S = 0.2  # a wait without end would not let every system's Ctrl-C in


class SideJob(Closing, Generic[Result]):
    """Runs `work`, which tells its progress. Nobody sees that until somebody waits for the result. Use as a context:
    leaving it early interrupts the work where it next tells of itself, as Ctrl-C would.
    """

    def __init__(self, work: Callable[[NotedProgress], Result], report: NotedProgress) -> None:
        self._report = report
        self._awaited, self._over = Event(), Event()
        self._pool = ThreadPoolExecutor(1)
        self._future: Future[Result] = self._pool.submit(work, self._tell)

    def result(self) -> Result:
        """Return the work's result, or raise its error."""
        self._awaited.set()
        while not self._future.done():
            wait([self._future], CTRL_C_S)
        return self._future.result()

    def close(self) -> None:
        self._over.set()
        self._pool.shutdown()

    def _tell(self, what: str, fraction: float, note: str = "") -> None:
        if self._over.is_set():
            raise KeyboardInterrupt
        if self._awaited.is_set():
            self._report(what, fraction, note)
