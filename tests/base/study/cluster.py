"""A Dask scheduler and its workers on this machine, as `dask scheduler` and `dask worker` start them."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tools import ROOT


@dataclass
class Cluster:
    """A scheduler and its workers, each a process of its own."""

    address: str
    scheduler: subprocess.Popen[str]
    workers: list[subprocess.Popen[str]]


def begin(module: str, *options: str, python: Sequence[str] = (), **settings: str) -> subprocess.Popen[str]:
    command = [sys.executable, *python, "-m", f"distributed.cli.{module}", *options, "--no-dashboard"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **settings}
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)


def begin_worker(
    address: str, python: Sequence[str] = (), scheme: str = "tcp", **settings: str
) -> subprocess.Popen[str]:
    options = (f"{scheme}://{address}", "--nthreads", "1", "--no-nanny")
    return begin("dask_worker", *options, python=python, **settings)


def wait_for(process: subprocess.Popen[str], words: str) -> str:
    """The line of a process's messages that holds these words."""
    assert process.stderr is not None
    for line in process.stderr:
        if words in line:
            return line
    raise AssertionError(f"it ended before it said {words!r}")


@contextlib.contextmanager
def cluster_of(workers: int, scheme: str = "tcp", **settings: str) -> Iterator[Cluster]:
    with contextlib.ExitStack() as stack:
        scheduler = begin("dask_scheduler", "--host", f"{scheme}://127.0.0.1", "--port", "0", **settings)
        stack.callback(end, scheduler)
        address = wait_for(scheduler, "Scheduler at:").rpartition("://")[2].strip()
        running = []
        for _ in range(workers):
            running.append(begin_worker(address, scheme=scheme, **settings))
            stack.callback(end, running[-1])
        for worker in running:
            wait_for(worker, "Registered to:")
        yield Cluster(address, scheduler, running)


def end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()
