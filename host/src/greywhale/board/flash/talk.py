"""A line to a bootloader, an answer at a time."""

from __future__ import annotations

from collections.abc import Callable

from greywhale.protocol.transport import Line

_ASK_EVERY_S = 0.05  # a bootloader answers within milliseconds
# A bootloader that listens answers the first question; all kinds listen for at least half a second after the reset.
_TRY_S = 0.5


class Talk:
    """A bootloader's answers, in the pieces that are expected of it."""

    def __init__(self, line: Line) -> None:
        self.write = line.write
        self._line = line
        self._heard = b""

    def read(self, count: int, wait_s: float = _TRY_S) -> bytes:
        """So many bytes, or fewer where no more came in time."""
        self._wait(lambda: len(self._heard) >= count, wait_s)
        taken, self._heard = self._heard[:count], self._heard[count:]
        return taken

    def hear(self, question: bytes, answer: bytes) -> bool:
        """Ask again and again until the answer comes; whether it did. Answers to what was asked twice are dropped."""
        end = self._line.clock() + _TRY_S
        while answer not in self._heard and self._line.clock() < end:
            self.write(question)
            self._wait(lambda: answer in self._heard, _ASK_EVERY_S)
        if answer not in self._heard:
            return False
        while self.read(64, _ASK_EVERY_S):
            pass
        return True

    def _wait(self, done: Callable[[], bool], wait_s: float) -> None:
        end = self._line.clock() + wait_s
        while not done() and self._line.clock() < end:
            self._heard += self._line.read()
