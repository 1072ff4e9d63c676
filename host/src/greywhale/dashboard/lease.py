"""The lease of the motors that run for a page: it goes on while the page speaks and the board sends samples.

A short one, as for a pulse of a motor, is never renewed: the arm moves no longer than the page has asked for. Time is
that of the line.
"""

from __future__ import annotations

from enum import Enum, auto

from greywhale.dashboard.client import Client
from greywhale.dashboard.limits import BOARD
from greywhale.protocol import schema

_AT_REST = (schema.State.DISABLED, schema.State.FAULT)


class Due(Enum):
    """The next thing to do for a lease."""

    NOTHING = auto()
    RENEWAL = auto()
    STOP = auto()  # its page fell silent


class Lease:
    """At most one, that of the page for which the motors run or are about to."""

    def __init__(self) -> None:
        self.page: Client | None = None
        self.is_short = False
        self._begun_s = 0.0
        self._confirmed = False  # by the board, that they run
        self._renewed_s = 0.0

    def begin(self, page: Client, is_short: bool) -> None:
        """A page asks the board to start the motors."""
        self.page, self.is_short, self._confirmed = page, is_short, False
        self._begun_s = self._renewed_s = page.seen_s

    def end(self) -> None:
        self.page, self.is_short = None, False

    def note_answer(self, page: Client, refused: bool) -> None:
        """The board answers what this page has asked for to start them."""
        if page is self.page:
            self._confirmed = True
            if refused:
                self.end()

    def note_state(self, state: int) -> None:
        """A sample tells in which state the board is: motors that it has turned off have no lease."""
        if self._confirmed and state in _AT_REST:
            self.end()

    def look(self, now_s: float, heard_s: float) -> Due:
        """The act that is due now; the board's last sample came at `heard_s`."""
        if self.page is None:
            return Due.NOTHING
        if self.is_short:
            if now_s > self._begun_s + BOARD.lease_ms / 1000:  # the board has ended it, or never began
                self.end()
            return Due.NOTHING
        if now_s > self.page.seen_s + BOARD.page_silence_s:
            return Due.STOP
        if now_s >= self._renewed_s + BOARD.renew_s and now_s <= heard_s + BOARD.no_renewal_s:
            self._renewed_s = now_s
            return Due.RENEWAL
        return Due.NOTHING
