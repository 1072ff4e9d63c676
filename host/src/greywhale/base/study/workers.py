"""Runs the tasks of a study: in any executor, this process, processes of its own, or a scheduler's workers.

The processes here are spawned, not forked: a fork would copy the state of other threads (a progress bar's, for
example) with their locks. They end with this process, however it ends, and at once when a study is left.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from multiprocessing import resource_tracker
from typing import ParamSpec, Protocol, TypeVar

from greywhale.base import interrupts, system
from greywhale.base.errors import BadUsage
from greywhale.base.processes import safe_path
from greywhale.base.study.cluster import ClusterWorkers

P = ParamSpec("P")
T = TypeVar("T")


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


class SerialWorkers:
    at_once = 1

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        yield _Serial()


class _Serial(Executor):
    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class LocalWorkers:
    """So many processes on this machine; without a number, one for every processor. Each calls `prepare` first."""

    def __init__(self, count: int | None = None, prepare: Callable[[], object] = int) -> None:
        self.at_once = count or os.cpu_count() or 1
        self._prepare = prepare

    @contextlib.contextmanager
    def executor(self) -> Iterator[Executor]:
        context = multiprocessing.get_context("spawn")
        theirs, ours = context.Pipe(duplex=False)
        # The pool's semaphores start multiprocessing's resource tracker, which would find one lost if Ctrl-C came
        # between its making and its entry.
        with safe_path(), _hold_interrupts():
            pool = _Pool(self.at_once, mp_context=context, initializer=_prepare, initargs=(theirs.recv, self._prepare))
        try:
            yield pool
        except BaseException:
            ours.close()
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
            ours.close()
            theirs.close()


class _Left(Exception):
    """Workers that are left after an error end at once."""


@contextlib.contextmanager
def left_at_once(workers: Workers) -> Iterator[Executor]:
    """Their executor; leaving it waits for no task."""
    with contextlib.suppress(_Left), workers.executor() as executor:
        yield executor
        raise _Left


def choose_workers(count: int | None = None, scheduler: str | None = None) -> Workers:
    """As --workers and --scheduler of a verb say: this process where the count is 1, else so many, without it one for
    every processor; or those of the Dask scheduler at an address. BadUsage where both are given, or no such address.
    """
    if scheduler is None:
        return SerialWorkers() if count == 1 else LocalWorkers(count)
    if count is not None:
        raise BadUsage(
            "--workers is how many processes work here, but --scheduler has workers of its own; leave out one."
        )
    return ClusterWorkers(scheduler)


class _Pool(ProcessPoolExecutor):
    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        with safe_path(), _hold_interrupts():  # it may start a process
            return super().submit(fn, *args, **kwargs)


def _prepare(receive: Callable[[], object], prepare: Callable[[], object]) -> None:
    """In a new process: end when the other end of the line is closed, and leave Ctrl-C to the process there."""

    def follow() -> None:
        with contextlib.suppress(EOFError, OSError):
            receive()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()
    # A handler that does nothing, and no mask: a program that a task starts then hears Ctrl-C.
    signal.signal(signal.SIGINT, lambda number, frame: None)
    system.hear_interrupts()
    prepare()


@contextlib.contextmanager
def _hold_interrupts() -> Iterator[None]:
    """Hold Ctrl-C back while other processes are started.

    Ctrl-C reaches all processes of a terminal, but only this one may answer it. The others inherit the mask.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    if system.HANDS_DOWN_DESCRIPTORS:  # else there is no tracker
        # Starting it removes the mask, so it must run already when the others start.
        resource_tracker.ensure_running()
    with interrupts.hold_back(signal.SIGINT, signal.SIGTERM), system.no_interrupts_for_children():
        yield
