"""One search at a time, whose outcome comes once; leaving waits for none."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from typing import Any

import pytest

from greywhale.adapt.background import background
from greywhale.base.errors import UserError


class Held(Executor):
    """Keeps what it is given until the test says what came of it."""

    at_once = 1

    def __init__(self) -> None:
        self.future: Future[Any] = Future()
        self.left_early = False

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        return self.future

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        try:
            yield self
        except BaseException:
            self.left_early = True
            raise


def test_an_outcome_comes_once_and_nobody_waits_for_it() -> None:
    held = Held()
    with background(held) as searches:
        assert not searches.busy
        searches.begin(object())  # type: ignore[arg-type] # nobody looks at it
        assert searches.busy
        assert searches.take() is None
        held.future.set_result("found")
        assert searches.take() == "found"
        assert searches.take() is None
        assert not searches.busy
    assert held.left_early


def test_a_search_whose_process_ended_is_one_sentence() -> None:
    held = Held()
    held.future.set_exception(BrokenExecutor())
    with background(held) as searches:
        searches.begin(object())  # type: ignore[arg-type] # nobody looks at it
        with pytest.raises(UserError, match="start again"):
            searches.take()
