"""What a study needs to know of those who do its tasks."""

from __future__ import annotations

from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from typing import Protocol


class Workers(Protocol):
    """Those who do the tasks of a study; leaving `executor()` after an error ends them at once.

    `at_once` is how many tasks they are given at a time, None for all.
    """

    @property
    def at_once(self) -> int | None: ...

    def executor(self) -> AbstractContextManager[Executor]: ...


class Given:
    """An executor that somebody else made and will end."""

    at_once = None

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def executor(self) -> AbstractContextManager[Executor]:
        return nullcontext(self._executor)
