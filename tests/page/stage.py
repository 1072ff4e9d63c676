"""The page on a stage: the real server around a bench in lock step, and a browser in which time cannot run away.

The board lives a moment from each sign of life of the page that drives, and then waits for the next one. So a slow
browser holds the board up, and never loses its lease; whoever wants a page to fall silent lets the board live on. Each
tick costs the server, the page and this machine time, so a board at rest lives less.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from playwright.sync_api import Browser, BrowserContext, Page, Request, expect, sync_playwright

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.dashboard import server
from greywhale.dashboard.access import Access
from greywhale.dashboard.answers import Answers
from greywhale.dashboard.bench import BenchControls
from greywhale.dashboard.client import STARTS, Client
from greywhale.dashboard.folder import Folder
from greywhale.dashboard.history import FRAME_BYTES, History
from greywhale.dashboard.port_holder import turn
from greywhale.dashboard.relay import Relay
from greywhale.protocol.declared import Parameter
from greywhale.protocol.frames import FrameDecoder
from greywhale.protocol.schema import (
    DEFAULTS,
    EnableRequest,
    HelloReply,
    HelloRequest,
    LeadPointRequest,
    LeadRequest,
    ParamGetReply,
    ParamGetRequest,
    RenewRequest,
    Sample,
    State,
    StopRequest,
    param_crc,
)
from greywhale_sim.bench import SLICE_S
from greywhale_sim.leader_player import LET_GO_S
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.words import lock_step
from tests.dashboard.browser import BoardSocket
from tests.dashboard.browser import Page as Watcher
from tests.dashboard.shared import jobs_of

CHROMIUM = "/usr/bin/chromium"
FLAGS = [
    # One renderer for all pages, on whatever port: to start one takes longer than most tests.
    *("--renderer-process-limit=1", "--disable-site-isolation-trials"),
    *("--no-sandbox", "--disable-background-timer-throttling", "--disable-gpu-compositing"),
    *("--disable-accelerated-2d-canvas", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
]
FRAME_MS = 200  # a page draws so rarely: software draws, and the time is better spent on what is tested
PATIENCE_MS = 60_000  # a page that shows nothing for so long has hung
# So long the board lives after a request of a verb and, every 0.1 s, a page's sign of life.
MOVING_S, RESTING_S, ANSWER_S = 0.2, 0.03, 0.005
# And after each lease of a verb: longer than to the next one, shorter than the points last that a board keeps.
LEASED_S = 0.15
# And after the point of a lead: until a pulse of a motor has ended, and what it moved is at rest. Before the point
# it lives for the answers alone, for the lease of a pulse is short.
PULSE_S = 0.5
# All that it lives before the point, however late a starved page sends it and however often others ask meanwhile.
BEFORE_POINT_S = 0.05
LEASES = {EnableRequest.TYPE, LeadRequest.TYPE, RenewRequest.TYPE}
ENDED = UserError("the bench has ended.")
# A page waits half a second for an answer, four times. Here the board answers in its own time, on any machine.
OWN_TIME = f"""
  const wait = setTimeout;
  requestAnimationFrame = (draw) => wait(draw, {FRAME_MS}, performance.now());
  setTimeout = (act, ms = 0, ...given) => wait(act, ms < 500 ? ms : {PATIENCE_MS} / 4, ...given);
"""


class Stage:
    """A context: server and board. `page_address` is what a person would open, but with `view` first: to draw the arm
    of Start costs more than all else on the page.
    """

    view = "live"

    def __init__(self, folder: Path, *options: str) -> None:
        """`options` are the bench's."""
        self._options = options
        self.plugged = threading.Event()  # the board comes with it
        self.plugged.set()
        self.relay = _PacedRelay(self)
        self.folder = folder
        own = Folder(folder)
        self.jobs = jobs_of(self.relay, own)
        self.bench = _Bench(self)
        self.answers = Answers(self.relay, own, "default", self.jobs, BenchControls(self.bench, own))
        self._listener = server.listen()
        self.port: int = self._listener.getsockname()[1]
        self.access = Access(self.port)
        self._server = server.make_server(
            server.application(self.answers, server.require_page(), self.access, self.port)
        )
        self._ready = threading.Condition()
        self.still = False  # only a stop lets the board live
        self._until_s = 0.0
        self._now_s = 0.0
        self._point_by_s = 0.0
        self._ending = False
        self._commands: list[tuple[str, Future[dict[str, Any]]]] = []

    @property
    def page_address(self) -> str:
        return f"{self.access.address()}&view={self.view}"

    def stand_still(self) -> int:
        """Let time stand still until a stop comes; the tick at which it stands."""
        self.still = True
        self.wait_for(lambda: self._now_s >= self._until_s)
        return self.newest().tick

    def live(self, seconds: float) -> None:
        """Let the board live on from now, whoever is there, and wait until it has."""
        end_s = self.let_live(seconds)
        self.wait_for(lambda: self._now_s >= end_s)

    def let_live(self, seconds: float) -> float:
        """Give the board time from now on; when it ends."""
        with self._ready:
            end_s = self._now_s + seconds
            if self.relay.awaits_point:
                end_s = min(self._now_s + ANSWER_S, self._point_by_s)
            self._until_s = max(self._until_s, end_s)
            self._ready.notify_all()
        return end_s

    def wait_for(self, condition: Callable[[], bool]) -> None:
        """Wait for what the board does in the time that it has."""
        with self._ready:
            assert self._ready.wait_for(condition, PATIENCE_MS / 1000)

    def let_live_no_longer(self, seconds: float) -> None:
        """Take back what time the board was given beyond this; an awaited point comes within `BEFORE_POINT_S`."""
        with self._ready:
            self._point_by_s = self._now_s + BEFORE_POINT_S
            self._until_s = min(self._until_s, self._now_s + seconds)

    def command(self, text: str) -> dict[str, Any]:
        """The answer of the bench to a command, such as `pot follower 1 open`."""
        asked: Future[dict[str, Any]] = Future()
        with self._ready:
            if self._ending:
                raise ENDED
            self._commands.append((text, asked))
            self._ready.notify_all()
        return asked.result()

    def hold(self, degrees: int) -> None:
        """Let the leader rest there; hands take the arms so long after the motors went off."""
        self.live(LET_GO_S + SLICE_S)
        self.command(f"hold {degrees}")

    def runs(self, *changed: Parameter) -> dict[str, int]:
        """The raw values of these parameters, asked by another client; all others of the running set are defaults."""
        with Watcher(self.port, self.access.token).open("/board") as socket:
            board, values = BoardSocket(socket), list(DEFAULTS)
            for one in changed:
                reply = board.frame(ParamGetReply.TYPE, board.ask(ParamGetRequest(one.index)))
                values[one.index] = ParamGetReply.unpack(reply.payload).value
            hello = HelloReply.unpack(board.frame(HelloReply.TYPE, board.ask(HelloRequest())).payload)
        assert hello.param_crc == param_crc(values)
        return {one.name: values[one.index] for one in changed}

    def samples(self) -> list[Sample]:
        """All that the board has sent."""
        return [Sample.unpack(frame.payload) for frame in FrameDecoder().feed(self.relay.history.since(None))]

    def newest(self) -> Sample:
        """The last that the board has sent."""
        (frame,) = FrameDecoder().feed(self.relay.history.since(None)[-FRAME_BYTES:])
        return Sample.unpack(frame.payload)

    def _live(self, bench: LockStepBench) -> None:
        self.plugged.wait()
        with Device(bench.port, restart=False) as device:
            line, session = device.lend()
            self.relay.open(line, bench.port, session.refuse_motion)
            start_s = line.clock()
            while True:
                with self._ready:
                    self._now_s = line.clock() - start_s
                    self._ready.notify_all()
                    self._ready.wait_for(lambda: self._ending or self._commands or self._now_s < self._until_s)
                    if self._ending:
                        break
                    commands, self._commands = self._commands, []
                for text, asked in commands:
                    try:
                        asked.set_result(bench.command(text))
                    except UserError as error:
                        asked.set_exception(error)
                turn(self.relay, line, session)
            for _, asked in self._commands:
                asked.set_exception(ENDED)
            self.relay.close(bench.port, "")

    @contextlib.contextmanager
    def open(self) -> Iterator[LockStepBench]:
        with lock_step(*self._options) as bench:
            threads = [
                threading.Thread(target=self._live, args=(bench,)),
                threading.Thread(target=self._server.run, args=([self._listener],)),
            ]
            for thread in threads:
                thread.start()
            try:
                yield bench
            finally:
                self.plugged.set()
                self.jobs.close()
                with self._ready:
                    self._ending = True
                    self._ready.notify_all()
                self._server.should_exit = True
                for thread in threads:
                    thread.join()


@dataclass
class _Bench:
    """The bench as the server has it: commands go to the thread in which the board lives."""

    stage: Stage
    port = "in lock step"

    def command(self, text: str) -> dict[str, Any]:
        return self.stage.command(text)


class _PacedRelay(Relay):
    def __init__(self, stage: Stage) -> None:
        super().__init__(History())
        self._stage = stage
        self._frames = FrameDecoder()
        self.moves = False
        self.awaits_point = False  # of a page that leads

    def _let_live(self) -> None:
        if not self._stage.still:
            self._stage.let_live(MOVING_S if self.moves else RESTING_S)

    def seen(self, client: Client) -> None:
        super().seen(client)
        if self.members.driver in (client, None) and not (self.members.verb and self.moves):
            self._let_live()

    def release(self, client: Client) -> None:
        """What others have asked meanwhile is answered."""
        super().release(client)
        self._let_live()

    def receive(self, client: Client, data: bytes) -> None:
        """Where a verb moves the arm, the board lives from one renewal to the next, so the lease never ends."""
        super().receive(client, data)
        asked = {frame.type for frame in FrameDecoder().feed(data)}
        if client.verb:
            self._stage.let_live(LEASED_S if asked & LEASES else ANSWER_S)
        elif StopRequest.TYPE in asked:
            self.awaits_point = False
            self._stage.let_live(1.0)
        elif asked & STARTS:  # from now on the board waits for the page, also where a stop had given it more time
            self.awaits_point = LeadRequest.TYPE in asked
            self._stage.let_live_no_longer(ANSWER_S if self.awaits_point else MOVING_S)
        elif LeadPointRequest.TYPE in asked:
            self.awaits_point = False
            self._stage.let_live(PULSE_S)

    def heard(self, data: bytes) -> None:
        super().heard(data)
        for frame in self._frames.feed(data):
            if frame.type == Sample.TYPE:
                self.moves = Sample.unpack(frame.payload).state in (State.SOFT_START, State.FOLLOWING)


@dataclass
class Visit:
    """A page in a browser, and what it did that no page may do."""

    page: Page
    strange: list[str] = field(default_factory=list)


@contextlib.contextmanager
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        expect.set_options(timeout=PATIENCE_MS)
        running = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield running
        running.close()


@contextlib.contextmanager
def profile(browser: Browser) -> Iterator[BrowserContext]:
    """What all pages of a test run share; each has an address, and so a memory, of its own."""
    # As small as a page may be that still stands in two columns: software draws.
    context = browser.new_context(viewport={"width": 960, "height": 700})
    context.new_page()  # keeps the renderer
    yield context
    context.close()


class Place(Protocol):
    """Who hands out a page, on this machine."""

    @property
    def port(self) -> int: ...
    @property
    def page_address(self) -> str: ...


@contextlib.contextmanager
def visit(context: BrowserContext, stage: Place, script: str = "") -> Iterator[Visit]:
    """Open the page, in which a script may run first; afterwards, every request that left the server, every error and
    every broken policy is told.
    """
    page = context.new_page()
    page.add_init_script(OWN_TIME + script)
    page.set_default_timeout(PATIENCE_MS)
    told = Visit(page)
    address = stage.page_address
    here = (address, f"http://127.0.0.1:{stage.port}/", f"ws://127.0.0.1:{stage.port}/", "data:", "blob:")

    def judge(request: Request) -> None:
        if not request.url.startswith(here):
            told.strange.append(f"asked for {request.url}")

    page.on("request", judge)
    page.on("websocket", lambda socket: None if socket.url.startswith(here) else told.strange.append(socket.url))
    page.on("pageerror", lambda error: told.strange.append(str(error)))
    page.on("console", lambda said: told.strange.append(said.text) if said.type == "error" else None)
    page.goto(address)
    yield told
    page.close()
    assert told.strange == []


def await_state(page: Page, state: str) -> None:
    """Wait until the page shows this state of the board. `expect` would look once a second, and this at once."""
    shown = "state => document.querySelector('.pill')?.textContent === state"
    page.wait_for_function(shown, arg=state, polling=50)
