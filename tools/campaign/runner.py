"""Does the pieces of a part in processes of their own."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager

from tools.campaign.journal import Journal
from tools.campaign.part import Part, Piece


def _ignore_interrupts() -> None:
    """Ctrl-C reaches every process of the terminal; the first one ends the others."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def open_pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """A process for each piece. Ctrl-C lets those that run end, and begins no other."""
    with ProcessPoolExecutor(workers, initializer=_ignore_interrupts, max_tasks_per_child=1) as pool:
        try:
            yield pool
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def do_all(part: Part, pieces: list[Piece], journal: Journal, pool: ProcessPoolExecutor) -> None:
    """Do what is missing; each piece that is finished is kept at once."""
    missing = journal.missing(pieces)
    running = {pool.submit(part.run, piece): piece for piece in missing}
    began = time.monotonic()
    for number, future in enumerate(as_completed(running), 1):
        journal.add(running[future], future.result())
        left = (time.monotonic() - began) / number * (len(missing) - number)
        print(f"\r{part.name}: {number} of {len(missing)} pieces, about {left / 60:.0f} min left ", end="", flush=True)
    if missing:
        print()
