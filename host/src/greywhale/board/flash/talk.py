"""A line to a bootloader, an answer at a time."""

from __future__ import annotations

from collections.abc import Callable

from greywhale.board.flash import rules
from greywhale.protocol.transport import Line


class Talk:
    """A bootloader's answers, in the pieces that are expected of it."""

    def __init__(self, line: Line) -> None:
        self.write = line.write
        self._line = line
        self._heard = b""

    def read(self, count: int, wait_s: float = rules.ANSWER_S) -> bytes:
        """So many bytes, or fewer where no more came in time."""
        self._wait(lambda: len(self._heard) >= count, wait_s)
        taken, self._heard = self._heard[:count], self._heard[count:]
        return taken

    def hear(self, question: bytes, answer: bytes, lost: bool) -> bool:
        """Ask again and again until the answer comes; whether it did. Answers to what was asked twice are dropped."""
        questions, every_s = rules.QUESTIONS, rules.ASK_EVERY_S
        if lost:
            questions, every_s = rules.QUESTIONS_AFTER_LOSS, rules.ASK_AFTER_LOSS_S
        for _ in range(questions):
            self.write(question)
            self._wait(lambda: answer in self._heard, every_s)
            if answer in self._heard:
                while self.read(64, rules.STILL_S):
                    pass
                return True
        return False

    def _wait(self, done: Callable[[], bool], wait_s: float) -> None:
        end = self._line.clock() + wait_s
        while not done() and self._line.clock() < end:
            self._heard += self._line.read()
