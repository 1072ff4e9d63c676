"""Does the pieces of work in processes, and keeps each result in a file, so that a run goes on where it was ended.

A result depends on its task alone, so the number of processes and their order change nothing.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, ProcessPoolExecutor, wait
from functools import cache
from multiprocessing import connection
from pathlib import Path
from typing import Any

from greywhale.errors import UserError, os_reason
from greywhale.formats.whole import write_text
from greywhale.reproduce.request import Request
from greywhale.reproduce.task import Task
from greywhale.reproduce.tasks import tasks_of

Results = dict[str, dict[str, Any]]
Report = Callable[[str, float, str], None]
RESULTS = "results"
SOURCE = Path(__file__).resolve().parents[1]
DOING = "reproducing"
SHOWING = {"cli", "pages", "pictures", "render"}


def run(request: Request, folder: Path, workers: int, report: Report | None = None) -> Results:
    """Everything that a request asks for. An interrupt keeps what is done in `folder`."""
    told = report or (lambda what, fraction, note: None)
    tasks = tasks_of(request)
    results: Results = {}
    try:
        (folder / RESULTS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{folder}: cannot be made: {os_reason(error)}.") from None
    with _pool(workers) as pool:
        for key, result in _run_all(tasks, folder / RESULTS, pool):
            results[key] = result
            told(DOING, len(results) / len(tasks), key)
    return results


@contextlib.contextmanager
def _pool(workers: int) -> Iterator[Executor | None]:
    """Processes that Ctrl-C ends together with this one; None where one is enough, which is this."""
    if workers <= 1:
        yield None
        return
    pool = ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), initializer=_belong_to_parent)
    try:
        yield pool
    except BaseException:
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _belong_to_parent() -> None:
    """In a process of the pool: Ctrl-C is for the parent, which then ends this one; so does the parent's own end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def follow() -> None:
        connection.wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


def _run_all(tasks: Sequence[Task], folder: Path, pool: Executor | None) -> Iterator[tuple[str, dict[str, Any]]]:
    left = []
    for task in tasks:
        known = _kept(task, folder)
        if known is None:
            left.append(task)
        else:
            yield task.key, known
    if pool is None:
        for task in left:
            yield task.key, _keep(task, do(task), folder)
        return
    futures = {pool.submit(do, task): task for task in left}
    while futures:
        for future in wait(futures, return_when=FIRST_COMPLETED).done:
            task = futures.pop(future)
            yield task.key, _keep(task, future.result(), folder)


def do(task: Task) -> dict[str, Any]:
    """Do one piece of work with one thread; its result as JSON would give it back."""
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1):
        result: dict[str, Any] = json.loads(json.dumps(task.run()))
    return result


def _path(task: Task, folder: Path) -> Path:
    return folder / f"{task.key.replace(' ', '_')}.json"


def _facts(task: Task) -> dict[str, Any]:
    facts: dict[str, Any] = json.loads(json.dumps(task.facts()))
    return facts | {"program": program_digest()}


def _kept(task: Task, folder: Path) -> dict[str, Any] | None:
    """The result of an earlier run of the same task by the same program."""
    try:
        kept = json.loads(_path(task, folder).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(kept, dict) or kept.get("task") != _facts(task):
        return None
    result: dict[str, Any] = kept["result"]
    return result


def _keep(task: Task, result: dict[str, Any], folder: Path) -> dict[str, Any]:
    write_text(_path(task, folder), json.dumps({"task": _facts(task), "result": result}) + "\n")
    return result


@cache
def program_digest() -> str:
    """SHA-256 of this package's files, what only shows apart: results of another program are not taken."""
    digest = hashlib.sha256()
    for path in sorted(SOURCE.rglob("*")):
        if path.suffix in (".py", ".toml", ".so") and not SHOWING & set(path.parts) and path.is_file():
            digest.update(str(path.relative_to(SOURCE)).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()
