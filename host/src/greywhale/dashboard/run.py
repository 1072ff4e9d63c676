"""Puts a dashboard together and serves it until it is ended: motors off and port free then."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import FrameType

import uvicorn

from greywhale.base import system
from greywhale.base.bench_process import RunningBench
from greywhale.dashboard import server
from greywhale.dashboard.access import Access
from greywhale.dashboard.answers import Answers
from greywhale.dashboard.bench import BenchControls
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.history import History
from greywhale.dashboard.jobs import Jobs
from greywhale.dashboard.port_holder import PortHolder
from greywhale.dashboard.relay import Relay
from greywhale.dashboard.verbs import VerbFacts


def serve(
    port: str | None,
    arm: str,
    path: Path,
    http_port: int,
    catalogue: Callable[[], list[VerbFacts]],
    program: Sequence[str],
    bench: RunningBench | None,
    follows: bool,
    ready: Callable[[Access], None],
) -> None:
    """Serve until Ctrl-C; `ready` gets the access to it when the page can be opened.

    `port` is the board's, None for the only one found; verbs work in the folder `path`; `catalogue` and `program` are
    as in `Jobs`; `follows` is whether the bench's arm may follow as soon as a page is open.
    """
    page = server.require_page()
    folder, relay = Folder(path), Relay(History())
    holder = PortHolder(relay, port)
    jobs = Jobs(relay, folder, catalogue, program, holder.away)
    answers = Answers(relay, folder, arm, jobs, None if bench is None else BenchControls(bench, folder), follows)
    with contextlib.ExitStack() as held:
        listener = held.enter_context(server.listen(http_port))
        served: int = listener.getsockname()[1]
        access = Access(served)
        running = server.make_server(server.application(answers, page, access, served))
        held.callback(holder.close)
        held.callback(jobs.close)  # first, while their board is there
        held.enter_context(_ending_on_hangup(running))
        holder.start()
        ready(access)
        running.run([listener])


@contextlib.contextmanager
def _ending_on_hangup(running: uvicorn.Server) -> Iterator[None]:
    """End in good order with the terminal too; uvicorn sees to the other signals. nohup means what it says."""

    def end(number: int, frame: FrameType | None) -> None:
        running.should_exit = True

    before = signal.getsignal(system.HANG_UP)
    if before is not signal.SIG_IGN:
        signal.signal(system.HANG_UP, end)
    try:
        yield
    finally:
        signal.signal(system.HANG_UP, before)
