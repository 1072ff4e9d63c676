"""Runs a study: gives its tasks to workers, keeps what comes back, and does again what a lost worker had."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, wait
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from threadpoolctl import threadpool_limits

from greywhale.base.errors import UserError
from greywhale.base.study.results import Results
from greywhale.base.study.task import Task, do
from greywhale.base.study.workers import DEATHS, Given, Workers
from greywhale.base.types import Progress


class LostTasks(UserError):
    """Tasks ended their workers again and again; `results` are those of all others."""

    def __init__(self, message: str, results: dict[str, Any] | None = None) -> None:
        super().__init__(message)
        self.results = results or {}


def run_study(
    tasks: Sequence[Task],
    executor: Executor | Workers,
    results: Path | None = None,
    progress: Progress | None = None,
    *,
    about: Mapping[str, Any] | None = None,
    what: str = "working",
) -> dict[str, Any]:
    """Do all tasks; their results by key, in the tasks' order (see the package's own text)."""
    (key, count), *_ = Counter(task.key for task in tasks).most_common(1) or [("", 0)]
    if count > 1:
        raise ValueError(f"{count} tasks have the key {key!r}")
    workers = Given(executor) if isinstance(executor, Executor) else executor
    with Results(results, tasks, about or {}) as kept, threadpool_limits(limits=1, user_api="blas"):
        run = _Run(tasks, workers, kept, lambda share: progress(what, share) if progress is not None else None)
        try:
            run.do_all()
        except (Exception, KeyboardInterrupt) as error:
            if results is not None:
                error.add_note(
                    f"{len(kept)} of {len(tasks)} tasks are done and kept in {results}; with it the same study goes on."
                )
            raise
        return kept.of(tasks)


class _Run:
    def __init__(self, tasks: Sequence[Task], workers: Workers, kept: Results, report: Callable[[float], None]) -> None:
        self._tasks = tasks
        self._workers = workers
        self._kept = kept
        self._report = report
        self._ready = deque(task for task in tasks if task.key not in kept)
        # Tasks that were with a worker that ended. At last each is done alone, so that nobody else's end counts.
        self._suspects: deque[Task] = deque()
        self._deaths: Counter[str] = Counter()
        self._lost: list[Task] = []
        self._fruitless = 0  # executors in a row that were lost before a task was done

    def do_all(self) -> None:
        self._tell()
        while self._ready or self._suspects:
            with self._workers.executor() as executor:
                self._use(executor)
        if self._lost:
            names = ", ".join(repr(task.key) for task in self._lost)
            told = f"task {names} was" if len(self._lost) == 1 else f"tasks {names} were"
            raise LostTasks(
                f"{told} given up, because every worker that did it ended (of too little memory, or by a crash).",
                self._kept.of(self._tasks),
            )

    def _use(self, executor: Executor) -> None:
        """Until all is done, or the executor is lost."""
        running: dict[Future[str], Task] = {}
        ended: SimpleQueue[Future[str]] = SimpleQueue()
        try:
            lost = False
            while not lost:
                while not lost and (task := self._next(len(running))) is not None:
                    lost = not self._begin(task, executor, running, ended)
                    while not ended.empty():
                        lost |= self._take(ended.get(), running)
                if not lost and not running:
                    return
                lost = lost or self._take(_wait_for_one(ended), running)
            # What else it had is lost as well, or was done just before.
            wait(running)
            for future in list(running):
                self._take(future, running)
            self._require_some_fruit()
        except Exception:
            for future in [future for future in running if future.done()]:
                with suppress(Exception):  # the first error is told
                    self._take(future, running)
            raise
        finally:
            for future in running:
                future.cancel()

    def _next(self, running: int) -> Task | None:
        """What to begin now."""
        if self._ready:
            at_once = self._workers.at_once
            return self._ready.popleft() if at_once is None or running < at_once else None
        return self._suspects.popleft() if self._suspects and not running else None

    def _begin(
        self, task: Task, executor: Executor, running: dict[Future[str], Task], ended: SimpleQueue[Future[str]]
    ) -> bool:
        """Whether the executor took the task."""
        try:
            future = executor.submit(do, task.packed())
        except BrokenExecutor:
            (self._suspects if self._deaths[task.key] else self._ready).appendleft(task)
            return False
        running[future] = task
        future.add_done_callback(ended.put)
        return True

    def _take(self, future: Future[str], running: dict[Future[str], Task]) -> bool:
        """Keep what a future brought; whether the executor is lost."""
        task = running.pop(future)
        if future.cancelled():  # not by this study: the executor lost its workers
            self._ready.append(task)
            return True
        error = future.exception()
        if error is None:
            self._kept.tell(task.key, future.result())
            self._fruitless = 0
            self._tell()
            return False
        if not isinstance(error, BrokenExecutor):
            raise error
        self._deaths[task.key] += 1
        (self._lost if self._deaths[task.key] == DEATHS else self._suspects).append(task)
        return True

    def _require_some_fruit(self) -> None:
        """With tasks left to share out, it is no single task's fault when every executor is lost at once."""
        self._fruitless += bool(self._ready)
        if self._fruitless == DEATHS:
            raise UserError(f"{DEATHS} times all workers ended before any task was done.")

    def _tell(self) -> None:
        self._report(len(self._kept) / len(self._tasks) if self._tasks else 1.0)


def _wait_for_one(ended: SimpleQueue[Future[str]]) -> Future[str]:
    """The next task that ends. A Ctrl-C just before a wait does not end that wait, so each wait is short."""
    while True:
        with suppress(Empty):
            return ended.get(timeout=0.5)
