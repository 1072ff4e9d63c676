"""The process in which the searches run, apart from the samples: neither samples nor lease ever wait for a search."""

from __future__ import annotations

import contextlib
import multiprocessing
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, Future

from greywhale.adapt.live_model import LiveModel
from greywhale.adapt.propose import Proposal, Task, work_on
from greywhale.base import system
from greywhale.base.errors import UserError
from greywhale.base.study import Workers, left_at_once

# A search gives way to the program that listens to the board: it gets half as much of a processor that both want. Each
# step takes a fifth, so more would leave nothing beside other programs of a busy computer.
NICENESS = 3


class Background:
    """At most one search, or fit, at a time."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._future: Future[Proposal | LiveModel] | None = None

    @property
    def busy(self) -> bool:
        return self._future is not None

    def begin(self, task: Task) -> None:
        self._future = self._executor.submit(_work, task)

    def take(self) -> Proposal | LiveModel | None:
        """Hand over what was found, once; None before that. Raises UserError where the process of the search ended."""
        if self._future is None or not self._future.done():
            return None
        future, self._future = self._future, None
        try:
            return future.result()
        except BrokenExecutor:
            raise UserError(
                "the process that searches in the background was ended, perhaps because memory was short; start again."
            ) from None


def _work(task: Task) -> Proposal | LiveModel:
    if multiprocessing.parent_process() is not None:
        system.give_way(NICENESS)
    return work_on(task)


@contextlib.contextmanager
def background(workers: Workers) -> Iterator[Background]:
    """Leaving it waits for no search."""
    with left_at_once(workers) as executor:
        yield Background(executor)
