"""A board in this process, shared by a relay whose time is the board's own: it lives only while a test lets it."""

from __future__ import annotations

import queue
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from greywhale.board.device import Device
from greywhale.cli.catalogue import catalogue
from greywhale.dashboard.client import Client
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.history import History
from greywhale.dashboard.job import Facts
from greywhale.dashboard.jobs import Jobs
from greywhale.dashboard.outbox import Outbox
from greywhale.dashboard.port_holder import turn
from greywhale.dashboard.relay import Relay
from greywhale.protocol import schema
from greywhale.protocol.declared import Message
from greywhale.protocol.frames import Frame, FrameDecoder, encode_frame

VERB = (sys.executable, str(Path(__file__).with_name("quick_job.py")))
PATIENCE_S = 120.0  # a verb that says nothing for so long hangs


def jobs_of(relay: Relay, folder: Folder, program: Sequence[str] = VERB) -> Jobs:
    """As the dashboard has them, over a board whose port nobody takes."""
    return Jobs(relay, folder, catalogue, program, nullcontext)


HERE_S = 0.1  # between two signs of life of a page that drives


class Shared:
    """A context."""

    def __init__(self, port: str, samples: int = 60_000) -> None:
        self._device = Device(port, restart=False)
        self.line, self.session = self._device.lend()
        self.relay = Relay(History(samples))
        self.relay.open(self.line, port, self.session.refuse_motion)

    def turn(self) -> None:
        turn(self.relay, self.line, self.session)

    def live(self, seconds: float, here: Viewer | None = None) -> None:
        """Let so much of the board's time pass; meanwhile a page says that it is there."""
        end = said = self.line.clock()
        end += seconds
        while (now := self.line.clock()) < end:
            if here is not None and now >= said + HERE_S:
                self.relay.seen(here.client)
                said = now
            self.turn()

    def page(self, every: int = 1) -> Viewer:
        """A page that has joined and wants samples."""
        page = Viewer(self)
        self.relay.join(page.client)
        page.client.every = every
        return page

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._device.close()


class Viewer:
    """A page's haul so far: words, answers and the bytes of samples."""

    def __init__(self, shared: Shared, verb: str | None = None) -> None:
        self._shared = shared
        self.ended: list[str] = []  # why a verb was to end
        self.client = Client(Outbox(lambda urgent: None, most_samples=60_000), verb, end=self.ended.append)
        self._sequence = 0
        self._words: list[dict[str, Any]] = []
        self._answers: list[bytes] = []
        self._samples = b""

    def ask(self, request: Message, seq: int | None = None) -> int:
        """Send a request; its number."""
        self._sequence = self._sequence % 255 + 1 if seq is None else seq
        self._shared.relay.receive(self.client, encode_frame(request.TYPE, self._sequence, request.pack()))
        return self._sequence

    def words(self, kind: str) -> list[dict[str, Any]]:
        """All messages of a kind since the last look."""
        self._look()
        found = [word for word in self._words if word["kind"] == kind]
        self._words = [word for word in self._words if word["kind"] != kind]
        return found

    def answers(self) -> list[Frame]:
        """All answers since the last look."""
        self._look()
        found, self._answers = FrameDecoder().feed(b"".join(self._answers)), []
        return found

    def raw(self) -> bytes:
        """The samples since the last look, as they came."""
        self._look()
        found, self._samples = self._samples, b""
        return found

    def samples(self) -> list[schema.Sample]:
        return [schema.Sample.unpack(frame.payload) for frame in FrameDecoder().feed(self.raw())]

    def _look(self) -> None:
        answers, samples = self.client.outbox.take()
        self._samples += samples
        for one in answers:
            if isinstance(one, bytes):
                self._answers.append(one)
            else:
                self._words.append(one)


class Desk:
    """Jobs over a board, and a page that drives."""

    def __init__(self, shared: Shared, folder: Path, program: Sequence[str] = VERB) -> None:
        self.shared = shared
        self.jobs: Jobs = jobs_of(shared.relay, Folder(folder), program)
        self.told: queue.Queue[Facts] = queue.Queue()
        self.jobs.listeners.append(lambda facts: self.told.put({**facts}))
        self.page: Viewer = shared.page(0)
        shared.relay.drive(self.page.client)

    def start(self, verb: str, **arguments: Any) -> str:
        return self.jobs.start({"verb": verb, "arguments": arguments}, self.page.client.id)["id"]

    def wait(self, id: str, until: Callable[[Facts], object] = lambda facts: facts["state"] != "running") -> Facts:
        while True:
            facts = self.told.get(timeout=PATIENCE_S)
            if facts["id"] == id and until(facts):
                return facts

    def run(self, verb: str, **arguments: Any) -> Facts:
        return self.wait(self.start(verb, **arguments))


@contextmanager
def living(shared: Shared) -> Iterator[None]:
    """Meanwhile the board lives in a thread."""
    ended = threading.Event()

    def live() -> None:
        while not ended.is_set():
            shared.turn()

    thread = threading.Thread(target=live)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
