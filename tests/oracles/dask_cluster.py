"""A Dask scheduler and its workers on this machine, by TLS, each a process as `dask scheduler` and `dask worker`
start them, and tasks that meet a lost worker.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.base.study import jobs
from tools import ROOT

ROLES = ("client", "scheduler", "worker")


def certify(folder: Path) -> dict[str, str]:
    """A certificate that has signed itself and its key, as authority and for all three roles: Dask's settings."""
    folder.mkdir()
    cert, key = str(folder / "cert.pem"), str(folder / "key.pem")
    kind = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj", "/CN=studies"]
    subprocess.run(["openssl", "req", "-x509", *kind, "-keyout", key, "-out", cert], check=True, capture_output=True)
    roles = {f"{role}.{what}": path for role in ROLES for what, path in (("cert", cert), ("key", key))}
    return {f"distributed.comm.tls.{name}": path for name, path in {"ca-file": cert, **roles}.items()}


def as_environment(settings: dict[str, str]) -> dict[str, str]:
    return {f"DASK_{name.replace('.', '__').replace('-', '_').upper()}": value for name, value in settings.items()}


@dataclass
class Cluster:
    """A running scheduler; `settings` are Dask's, its certificates among them, as environment."""

    settings: dict[str, str]
    address: str = ""
    scheduler: Any = None
    workers: list[subprocess.Popen[str]] = field(default_factory=list)
    _stack: contextlib.ExitStack = field(default_factory=contextlib.ExitStack)

    def add_workers(self, number: int, *python: str, **environment: str) -> None:
        """Start so many, and wait until the scheduler knows them."""
        options = (self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard")
        begun = [self._begin("worker", options, python, environment) for _ in range(number)]
        for worker in begun:
            _wait_for(worker, "Registered to:")
        self.workers += begun

    def begin_scheduler(self) -> None:
        self.scheduler = self._begin(
            "scheduler", ("--host", "tls://127.0.0.1", "--port", "0", "--no-dashboard"), (), {}
        )
        self.address = _wait_for(self.scheduler, "Scheduler at:").split()[-1]

    def _begin(
        self, role: str, options: tuple[str, ...], python: tuple[str, ...], environment: dict[str, str]
    ) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, *python, "-m", f"distributed.cli.dask_{role}", *options],
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT), **self.settings, **environment},
        )
        self._stack.callback(_end, process)
        return process

    def close(self) -> None:
        self._stack.close()


@contextlib.contextmanager
def cluster_of(workers: int, settings: dict[str, str], **environment: str) -> Iterator[Cluster]:
    with contextlib.closing(Cluster({**as_environment(settings), **environment})) as cluster:
        cluster.begin_scheduler()
        cluster.add_workers(workers)
        yield cluster


def _wait_for(process: subprocess.Popen[str], words: str) -> str:
    """The line of a process's messages that holds these words."""
    assert process.stderr is not None
    lines = []
    for line in process.stderr:
        lines.append(line)
        if words in line:
            return line
    raise AssertionError(f"it ended before it said {words!r}: {''.join(lines)}")


def _end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()


# --- tasks ----------------------------------------------------------------------------------------------------------


def hang_first(seed: int, folder: str, count: int) -> dict[str, Any]:
    """`jobs.draw`; but the first time it tells who has it, through the pipe `who`, and never ends."""
    try:
        os.close(os.open(Path(folder) / "first", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return jobs.draw(seed, count)
    (Path(folder) / "who").write_text(f"{os.getpid()}\n")
    threading.Event().wait()
    raise AssertionError("nothing sets the event")


def die(seed: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)
