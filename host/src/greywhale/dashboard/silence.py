"""A board that sends no samples: when pages are told, when it is asked again, when it is given up.

It may have restarted. A bootloader to which anybody speaks stays for 5 s. So soon, when this host's own delay cannot be
the reason, pages are told, and nothing but their stop is sent; when the board's firmware must run, it is asked for
samples again; at last it is given up. Time is that of the line.
"""

from __future__ import annotations

from enum import Enum, auto

REPORT_SILENCE_S = 0.5
ASK_AGAIN_S = 6.0
GIVE_UP_S = 7.0


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
        return now_s > self.heard_s + REPORT_SILENCE_S

    def look(self, now_s: float) -> Step:
        """The step that is due now, each once."""
        silent_s = now_s - self.heard_s
        if silent_s > GIVE_UP_S:
            return Step.GIVE_UP
        if silent_s > REPORT_SILENCE_S and not self._told:
            self._told = True
            return Step.TELL
        if silent_s > ASK_AGAIN_S and not self._asked_again:
            self._asked_again = True
            return Step.ASK_AGAIN
        return Step.NOTHING
