"""A board that sends no samples: when pages are told, when it is asked again, when it is given up.

It may have restarted. A bootloader to which anybody speaks stays for 5 s. So soon, when this host's own delay cannot be
the reason, pages are told, and nothing but their stop is sent; when the board's firmware must run, it is asked for
samples again; at last it is given up. Time is that of the line.
"""

from __future__ import annotations

from enum import Enum, auto

from greywhale.dashboard.limits import BOARD


class Step(Enum):
    """The next thing to do about a board that is silent."""

    NOTHING = auto()
    TELL = auto()
    ASK_AGAIN = auto()
    GIVE_UP = auto()


class Silence:
    """Of one board after the other."""

    def __init__(self) -> None:
        self.heard_s = 0.0  # when the last sample came
        self._told = self._asked_again = False

    def begin(self, now_s: float) -> None:
        """A board is there, or has restarted, and is asked for samples."""
        self.heard_s = now_s
        self._told = self._asked_again = False

    def end(self, now_s: float) -> bool:
        """A sample has come; True where pages know that the board was silent."""
        was_told = self._told
        self.begin(now_s)
        return was_told

    def lasts(self, now_s: float) -> bool:
        """True where the board has been silent for so long that nothing but a stop is sent."""
        return now_s > self.heard_s + BOARD.report_silence_s

    def look(self, now_s: float) -> Step:
        """The step that is due now, each once."""
        silent_s = now_s - self.heard_s
        if silent_s > BOARD.give_up_s:
            return Step.GIVE_UP
        if silent_s > BOARD.report_silence_s and not self._told:
            self._told = True
            return Step.TELL
        if silent_s > BOARD.ask_again_s and not self._asked_again:
            self._asked_again = True
            return Step.ASK_AGAIN
        return Step.NOTHING
