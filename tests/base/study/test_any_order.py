"""Whatever order tasks end in, and whenever workers are lost: every task is done, and nothing is told twice."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from greywhale.base.study import SerialWorkers, run_study
from tests.base.study import jobs

TASKS = jobs.draws(9)
SERIAL = run_study(TASKS, SerialWorkers())
Waiting = tuple[Future[Any], Callable[[], Any]]


class Unsteady(Executor):
    """Ends tasks in any order, in a thread of its own, until it breaks, or loses the one who gives it tasks."""

    def __init__(self, chance: random.Random, steps: int) -> None:
        self.chance = chance
        self.steps = steps  # until it breaks
        self.broken = False
        self.asked: SimpleQueue[Waiting | None] = SimpleQueue()
        self.thread = Thread(target=self.work)
        self.thread.start()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        if self.broken:
            raise BrokenExecutor
        future: Future[Any] = Future()
        self.asked.put((future, lambda: fn(*args, **kwargs)))
        return future

    def work(self) -> None:
        waiting: list[Waiting] = []
        while True:
            while not waiting or not self.asked.empty():
                one = self.asked.get()
                if one is None:
                    return
                waiting.append(one)
            self.steps -= 1
            if self.steps < 0:
                return self.end(waiting)
            future, do = waiting.pop(self.chance.randrange(len(waiting)))
            future.set_result(do())

    def end(self, waiting: list[Waiting]) -> None:
        self.broken = True
        cancelled = self.chance.random() < 0.3
        while True:
            for future, _ in waiting:
                if cancelled:
                    future.cancel()
                    future.set_running_or_notify_cancel()
                else:
                    future.set_exception(BrokenExecutor())
            one = self.asked.get()  # until nobody asks any more
            if one is None:
                return
            waiting = [one]


class UnsteadyWorkers:
    """The first executors break after these numbers of tasks, the last one never."""

    def __init__(self, seed: int, steps: list[int], at_once: int | None) -> None:
        self.chance = random.Random(seed)
        self.steps = steps
        self.at_once = at_once

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        executor = Unsteady(self.chance, self.steps.pop(0) if self.steps else 1000)
        try:
            yield executor
        finally:
            executor.asked.put(None)
            executor.thread.join()


@given(st.integers(0, 2**32), st.lists(st.integers(0, 5), max_size=2), st.sampled_from([1, 2, 3, None]))
@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_every_task_is_done_once_in_the_end(tmp_path: Path, seed: int, steps: list[int], at_once: int | None) -> None:
    """Two lost executors are not yet three, after which a task, or the study, is given up."""
    path = tmp_path / "r"
    path.unlink(missing_ok=True)
    shares: list[float] = []
    workers = UnsteadyWorkers(seed, steps, at_once)
    found = run_study(TASKS, workers, path, lambda what, share: shares.append(share))
    assert list(found) == list(SERIAL)
    assert all(found[key]["values"].tobytes() == SERIAL[key]["values"].tobytes() for key in SERIAL)
    assert shares == [number / len(TASKS) for number in range(len(TASKS) + 1)]
    assert path.read_bytes().count(b"\n") == len(TASKS) + 1
