"""A page whose navigator.serial leads to a bench in lock step, which lives while the page has the port open."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from playwright.sync_api import BrowserContext, Page

from greywhale.protocol.transport import BAUD, LINES, Line
from greywhale_sim.lockstep import LockStepBench
from tests.page import stage as stages
from tests.page.site.serve_folder import Site

# So long the board lives at a time: until it has answered what it was asked, and longer where it was asked nothing.
ANSWER_S, TURN_S, BOOTLOADER_TURN_S = 0.01, 0.06, 0.04
SCRIPT = Path(__file__).with_name("false_serial.js").read_text("utf-8")


class Sent(NamedTuple):
    """Bytes that the page has written: at which speed, and when in the board's time."""

    baud: int
    at_s: float
    text: str


class Cable:
    """From the page's port to a bench: it can be unplugged, and a port that is opened may restart the board."""

    def __init__(self, bench: LockStepBench) -> None:
        self.plugged = True
        self.opening_restarts = False
        self.restarts = 0
        self.sent: list[Sent] = []
        self._bench = bench
        self._line: Line | None = None
        self._baud = 0

    def carry(self, what: str, given: Any) -> Any:
        """What the false port asks of its other end; but for `open`, with what was written to it."""
        if what == "open":
            return self._open(given)
        if self._line is not None:
            self._line.write(given.encode("latin-1"))
            self.sent.append(Sent(self._baud, self._line.clock(), given))
        if what == "close" or not self.plugged:
            self._close()
        elif what == "restart":
            self._restart()
        return None if self._line is None else self._live(self._line, ANSWER_S if given else TURN_S)

    def _open(self, baud: int) -> str:
        if not self.plugged:
            return "Failed to open serial port."
        self._baud = baud
        self._line = LINES[self._bench.port](self.opening_restarts, baud)
        return ""

    def _restart(self) -> None:
        self._close()
        self.restarts += 1
        self._line = LINES[self._bench.port](True, self._baud)

    def _live(self, line: Line, turn_s: float) -> tuple[float, str]:
        """Let firmware live so long, a bootloader until it has said all; its time in ms, and what it said."""
        said, new, firmware = b"", b"", self._baud == BAUD
        end_s = line.clock() + (turn_s if firmware else BOOTLOADER_TURN_S)
        while line.clock() < end_s or (new and not firmware):
            new = line.read()
            if said and not new and not firmware:
                break
            said += new
        return 1000 * line.clock(), said.decode("latin-1")

    def _close(self) -> None:
        if self._line is not None:
            self._line.read()  # what was written goes out first
            self._line.close()
        self._line = None


@contextlib.contextmanager
def connected(context: BrowserContext, site: Site, bench: LockStepBench) -> Iterator[tuple[Page, Cable]]:
    """A page for the board at the port, which is not open yet."""
    cable = Cable(bench)
    with stages.visit(context, replace(site, said="?board=port#view=port"), SCRIPT) as visit:
        visit.page.expose_function("boardPort", cable.carry)
        yield visit.page, cable
