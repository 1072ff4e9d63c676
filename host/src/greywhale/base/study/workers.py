"""What a study needs to know of those who do its tasks."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from typing import Protocol

from greywhale.base.errors import UserError

# A task that ended its worker so often is given up.
DEATHS = 3


class Workers(Protocol):
    """Those who do the tasks of a study. `executor()` makes a new one whenever the last one is lost; leaving it after
    an error ends the workers at once.

    `at_once` is how many tasks they are given at a time, None for all. A future whose worker ended has a
    `BrokenExecutor`, or is cancelled.
    """

    @property
    def at_once(self) -> int | None: ...

    def executor(self) -> AbstractContextManager[Executor]: ...


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
