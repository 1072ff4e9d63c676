"""What a study needs to know of those who do its tasks."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor
from contextlib import AbstractContextManager
from typing import Protocol

from greywhale.base.errors import UserError

# A task that ended its worker so often is given up.
DEATHS = 3


class Workers(Protocol):
    """Those who do the tasks of a study. `executor()` makes a new one whenever the last one is lost; leaving it after
    an error ends the workers at once.

    `at_once` is how many tasks they are given at a time, None for all. `deaths` says how many workers' ends an error of
    a future stands for, 0 where it is the task's own.
    """

    @property
    def at_once(self) -> int | None: ...

    def executor(self) -> AbstractContextManager[Executor]: ...

    def deaths(self, error: BaseException) -> int: ...


class Given:
    """An executor that somebody else made and will end."""

    at_once = None

    def __init__(self, executor: Executor) -> None:
        self._executor: Executor | None = executor

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        executor, self._executor = self._executor, None
        if executor is None:
            raise UserError("the workers were lost, and this study cannot make new ones.")
        yield executor

    def deaths(self, error: BaseException) -> int:
        return 1 if isinstance(error, BrokenExecutor) else 0
