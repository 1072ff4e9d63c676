"""Does the pieces of all parts in processes of their own, every part as far as the others."""

from __future__ import annotations

import multiprocessing
import random
import signal
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass

from tools.attack.journal import Done, Journal
from tools.attack.part import Part, Piece, Row, add_up

Report = Callable[[int, int, float], None]  # pieces done, pieces in all, seconds so far


@dataclass(frozen=True)
class Result:
    """What a part has come to: the rows of its finished pieces.

    `longer` of the `most_longer` pieces beyond its full size are done as well. `seconds` is what a worker took over
    those of the full size.
    """

    part: Part
    rows: list[Row]
    done: int
    pieces: int
    longer: int = 0
    most_longer: int = 0
    seconds: float = 0.0

    @property
    def whole(self) -> bool:
        return self.done == self.pieces


@dataclass(frozen=True)
class Work:
    """A part, its pieces at this share, and those of them that are finished."""

    part: Part
    pieces: Sequence[Piece]
    journal: Journal

    def result(self) -> Result:
        asked, full = list(self.pieces), self.part.pieces(1.0)
        longest = self.part.pieces(self.part.longest) if asked == full else []
        beyond = [piece for piece in longest if piece not in full]
        rows = add_up(self.journal.rows([*asked, *beyond]))
        done, longer = (len(some) - len(self.journal.missing(some)) for some in (asked, beyond))
        return Result(self.part, rows, done, len(asked), longer, len(beyond), self.journal.seconds(asked))


def in_turn(works: Iterable[Work]) -> list[tuple[Work, Piece]]:
    """All that is missing, so that at any time every part, and each kind of piece in it, is as far as the others."""
    order = [
        ((place + 0.5) / len(work.pieces), number, work, piece)
        for number, work in enumerate(works)
        for place, piece in enumerate(_mixed(work.pieces))
        if work.journal.missing([piece])
    ]
    return [(work, piece) for _, _, work, piece in sorted(order, key=lambda one: one[:2])]


def _mixed(pieces: Sequence[Piece]) -> list[Piece]:
    """Boards and kinds mixed, in the same way each time."""
    return random.Random(len(pieces)).sample(list(pieces), len(pieces))


def do_all(works: Sequence[Work], workers: int, seconds: float, report: Report) -> None:
    """Do what is missing, a process for each piece; each that is finished is kept at once.

    After so many seconds, or with Ctrl-C, no other piece is begun. The processes are copies of one that has imported
    everything, which takes 3 s.
    """
    queue, began = in_turn(works), time.monotonic()
    total, done = len(queue), 0
    running: dict[Future[list[Row]], tuple[Work, Piece, float]] = {}
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tools.attack.parts"])
    with ProcessPoolExecutor(workers, context, _ignore_interrupts, max_tasks_per_child=1) as pool:
        while queue or running:
            if time.monotonic() - began > seconds:
                queue.clear()
            while queue and len(running) < workers:
                work, piece = queue.pop(0)
                running[pool.submit(work.part.run, piece)] = (work, piece, time.monotonic())
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                work, piece, since = running.pop(future)
                work.journal.add(Done(piece, add_up(future.result()), round(time.monotonic() - since, 1)))
                done += 1
                report(done, total, time.monotonic() - began)


def _ignore_interrupts() -> None:
    """Ctrl-C reaches every process of the terminal; the first one ends the others."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
