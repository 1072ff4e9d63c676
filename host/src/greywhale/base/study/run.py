"""Runs a study: gives its tasks to workers and keeps what comes back."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from threadpoolctl import threadpool_limits

from greywhale.base.errors import UserError
from greywhale.base.study.results import Results
from greywhale.base.study.task import Task, do
from greywhale.base.study.workers import Given, Workers
from greywhale.base.types import Progress


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

        def report() -> None:
            if progress is not None:
                progress(what, len(kept) / len(tasks) if tasks else 1.0)

        try:
            _do_all(tasks, workers, kept, report)
        except (Exception, KeyboardInterrupt) as error:
            if results is not None:
                error.add_note(
                    f"{len(kept)} of {len(tasks)} tasks are done and kept in {results}; with it the same study goes on."
                )
            raise
        return kept.of(tasks)


def _do_all(tasks: Sequence[Task], workers: Workers, kept: Results, report: Callable[[], None]) -> None:
    report()
    left = deque(task for task in tasks if task.key not in kept)
    if not left:
        return
    running: dict[Future[str], Task] = {}
    ended: SimpleQueue[Future[str]] = SimpleQueue()
    with workers.executor() as executor:
        try:
            while left or running:
                while left and (workers.at_once is None or len(running) < workers.at_once):
                    task = left.popleft()
                    future = executor.submit(do, task.packed())
                    running[future] = task
                    future.add_done_callback(ended.put)
                future = _wait_for_one(ended)
                kept.tell(running[future].key, _result(future, running[future]))
                del running[future]
                report()
        except Exception as error:
            for future, task in running.items():
                if future.done() and not future.cancelled() and future.exception() is None:
                    kept.tell(task.key, future.result())
            if isinstance(error, CancelledError):
                raise UserError("the scheduler of the workers went away; start it and the study again.") from None
            if isinstance(error, BrokenExecutor):
                raise _lost(running.values()) from None
            raise
        finally:
            for future in running:
                future.cancel()


def _result(future: Future[str], task: Task) -> str:
    try:
        return future.result()
    except UserError as error:
        error.add_note(f"(In task {task.key!r}.)")
        raise


def _lost(tasks: Iterable[Task]) -> UserError:
    """The error for a worker that ended; nobody knows which task ended it."""
    names = ", ".join(repr(task.key) for task in tasks)
    return UserError(
        f"a worker ended before its task was done (of too little memory, or by a crash); its task is among {names}. "
        "Start the study again, with fewer workers."
    )


def _wait_for_one(ended: SimpleQueue[Future[str]]) -> Future[str]:
    """The next task that ends. A Ctrl-C just before a wait does not end that wait, so each wait is short."""
    while True:
        with suppress(Empty):
            return ended.get(timeout=0.5)
