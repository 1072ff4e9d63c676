"""Shows the running step of a verb on stderr: two lines that stay in place on a terminal, elsewhere a line at times.

A step may be silent for minutes, so both are kept alive by a thread of their own.
"""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from rich.console import Console, ConsoleOptions, RenderResult
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from greywhale.base.errors import printable

LINE_EVERY_S = 30.0  # between two lines about one step
Clock = Callable[[], float]


@dataclass
class Step:
    what: str
    begun_s: float
    done_before: float  # share that was done at the beginning: it tells nothing about the speed
    fraction: float
    told_s: float
    note: str = ""

    def tell(self, fraction: float, note: str, now_s: float) -> None:
        self.fraction, self.note, self.told_s = fraction, note, now_s
        self.done_before = min(self.done_before, fraction)

    def state(self, now_s: float) -> str:
        """The share, for how long it has run, and how long it still takes where that is known; then the note."""
        parts = [f"{100 * self.fraction:.0f} %", f"{_minutes(now_s - self.begun_s)} so far"]
        gained = self.fraction - self.done_before
        if gained > 0.0:
            left_s = (self.told_s - self.begun_s) * (1.0 - self.fraction) / gained - (now_s - self.told_s)
            if left_s > 0.0:  # else the step is slower now than it was, and nobody knows
                parts.append(f"{_minutes(left_s)} left")
        return ", ".join([*parts, self.note] if self.note else parts)


class Running:
    """Keeps the running step; called with every report, it says whether a step began."""

    def __init__(self, clock: Clock = time.monotonic) -> None:
        self.clock = clock
        self.step: Step | None = None

    def __call__(self, what: str, fraction: float, note: str = "") -> bool:
        now_s = self.clock()
        what, note = printable(what), printable(note)
        if self.step is not None and self.step.what == what:
            self.step.tell(fraction, note, now_s)
            return False
        self.step = Step(what, now_s, fraction, fraction, now_s, note)
        return True


class Frame:
    """The running step as a terminal shows it: its name, below that a bar; where room is short, the note is cut."""

    def __init__(self, running: Running) -> None:
        self._running = running

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        step = self._running.step
        if step is None:
            return
        yield Text(step.what)
        length = max(1, min(24, options.max_width - 33))  # the share and the times stand beside it
        state = Text(step.state(self._running.clock()), no_wrap=True, overflow="ellipsis")
        row = Table.grid(padding=(0, 1))
        row.add_row(ProgressBar(total=1.0, completed=step.fraction, width=length), state)
        yield row


class Lines:
    """The running step as a pipe gets it: a line when it begins, unless somebody else tells that, and every 30 s."""

    def __init__(self, say: Callable[[str], None], running: Running, begins: bool = True) -> None:
        self._say = say
        self._running = running
        self._begins = begins
        self._said_s = self._begun_s = running.clock()
        self._lock = threading.Lock()

    def __call__(self, what: str, fraction: float, note: str = "") -> None:
        with self._lock:
            if self._running(what, fraction, note) and self._begins:
                self._tell(what)

    def look(self) -> None:
        """Say how far the step is, if nothing was said for so long."""
        with self._lock:
            step, now_s = self._running.step, self._running.clock()
            if step is not None and now_s - self._said_s >= LINE_EVERY_S:
                self._tell(f"{step.what}: {step.state(now_s)}")

    def _tell(self, text: str) -> None:
        self._said_s = self._running.clock()
        self._say(f"{_minutes(self._said_s - self._begun_s):>5}  {printable(text)}")


@contextlib.contextmanager
def shown(begins: bool) -> Iterator[Callable[..., object]]:
    """Show the reports of a verb on stderr, a terminal or not."""
    console = Console(stderr=True)
    running = Running()
    if sys.stderr.isatty() and console.is_terminal and not console.is_dumb_terminal:
        with Live(Frame(running), console=console, refresh_per_second=4.0, transient=True):
            yield running
        return
    lines = Lines(_say, running, begins)
    with repeated(lines.look, 1.0):
        yield lines


@contextlib.contextmanager
def repeated(do: Callable[[], None], every_s: float) -> Iterator[None]:
    """Meanwhile a thread does it again and again."""
    ended = threading.Event()

    def repeat() -> None:
        while not ended.wait(every_s):
            do()

    thread = threading.Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def _say(text: str) -> None:
    with contextlib.suppress(OSError, ValueError):  # whoever read it has gone; the work goes on
        print(text, file=sys.stderr, flush=True)


def _minutes(seconds: float) -> str:
    whole = int(seconds)
    return f"{whole // 60}:{whole % 60:02}"
