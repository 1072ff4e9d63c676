"""Runs what a benchmark repeats (arms, seeds, methods) as a study, which goes on after a kill.

GREYWHALE_WORKERS says in how many processes, or GREYWHALE_SCHEDULER on which Dask scheduler's workers, as --workers and
--scheduler do for verbs. A wall time among the figures is that of a machine of its own only with one worker.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Sequence
from typing import Any

from greywhale.base.study import Task, choose_workers, run_study
from tools import ROOT
from tools.setup import stamps

FOLDER = ROOT / "build" / "bench"
SOURCES = ("firmware/lib", "host/native", "host/src", "shared", "sim", "studies", "tools/benchmarks")


def repeat(name: str, tasks: Sequence[Task], workers: int = 1) -> dict[str, Any]:
    """Do the tasks; their results by key. Their file is kept until all are done, so that a new run measures anew."""
    chosen, scheduler = os.environ.get("GREYWHALE_WORKERS"), os.environ.get("GREYWHALE_SCHEDULER") or None
    count = int(chosen) if chosen else None if scheduler else workers
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}-{stamps.digest(stamps.files_below(*SOURCES))[:16]}.study"
    found = run_study(tasks, choose_workers(count, scheduler), path, _say, what=name)
    path.unlink()
    return found


def threads() -> int:
    """The threads that a task may use: all processors (0) in a process that works alone, one beside other workers."""
    return 0 if multiprocessing.parent_process() is None else 1


def _say(what: str, share: float) -> None:
    if sys.stderr.isatty():
        print(f"\r{what}: {share:.0%}", end="\n" if share == 1.0 else "", file=sys.stderr, flush=True)
