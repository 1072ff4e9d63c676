"""A line to a bootloader, an answer at a time."""

from __future__ import annotations

from collections.abc import Callable

from greywhale.protocol.transport import Line

_ANSWER_S = 0.5
# Questions, and the time for each. After a restart a bootloader that listens answers the first; the second is for one
# that was lost on the way. Optiboot, of newer Nanos, looks at nothing while it flashes its LED for 375 ms, and has room
# for one question then. Of more it loses bytes, and what it makes of the others starts the firmware.
_AFTER_RESTART = 2, 0.4
# After bytes were lost: the first questions end the message that lacks them.
_AFTER_LOSS = 10, 0.05
_STILL_S = 0.05  # after the last answer to a question that was asked twice


class Talk:
    """A bootloader's answers, in the pieces that are expected of it."""

    def __init__(self, line: Line) -> None:
        self.write = line.write
        self._line = line
        self._heard = b""

    def read(self, count: int, wait_s: float = _ANSWER_S) -> bytes:
        """So many bytes, or fewer where no more came in time."""
        self._wait(lambda: len(self._heard) >= count, wait_s)
        taken, self._heard = self._heard[:count], self._heard[count:]
        return taken

    def hear(self, question: bytes, answer: bytes, lost: bool) -> bool:
        """Ask again and again until the answer comes; whether it did. Answers to what was asked twice are dropped."""
        questions, every_s = _AFTER_LOSS if lost else _AFTER_RESTART
        for _ in range(questions):
            self.write(question)
            self._wait(lambda: answer in self._heard, every_s)
            if answer in self._heard:
                while self.read(64, _STILL_S):
                    pass
                return True
        return False

    def _wait(self, done: Callable[[], bool], wait_s: float) -> None:
        end = self._line.clock() + wait_s
        while not done() and self._line.clock() < end:
            self._heard += self._line.read()
