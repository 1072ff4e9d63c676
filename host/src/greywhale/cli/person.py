"""The person at this terminal, or a script that writes a line for each step."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Callable

import click

from greywhale.base import system
from greywhale.base.errors import UserError, cut
from greywhale.board.calibrate import PersonAnswer
from greywhale.cli.output import tell

WORDS = {
    "back": PersonAnswer.BACK,
    "again": PersonAnswer.AGAIN,
    "skip": PersonAnswer.SKIP,
    "yes": PersonAnswer.DONE,
    "": PersonAnswer.DONE,
}
WORDS |= {word[:1]: answer for word, answer in WORDS.items()}
LOOK_AGAIN_S = 0.5  # until it looks again if the terminal is this program's
NO = ("n", "no", "q", "quit")


def on_enter(act: Callable[[], None]) -> None:
    """Do this whenever Enter is pressed, until the terminal is closed."""
    while True:
        system.has_typed(sys.stdin, wait=True)
        if not system.in_foreground():  # the line is another program's, and to read it would stop this one
            time.sleep(LOOK_AGAIN_S)
            continue
        try:
            if not os.read(sys.stdin.fileno(), 4096):
                return
        except OSError:
            return
        act()


class Terminal:
    """Asks on stderr, reads from stdin. What was typed before a question is no answer to it; in a pipe each line is."""

    def __init__(self) -> None:
        self.patient = sys.stdin.isatty()
        self._live = sys.stderr.isatty()
        self._typed = b""
        self._shown = 0  # columns of the live reading

    def ask(self, what: str) -> None:
        self._forget_typed()
        self.tell(f"{what} [Enter]")

    def show(self, live: str) -> None:
        if self._live:
            text = live[: shutil.get_terminal_size().columns - 3]
            click.echo(f"\r  {text:<{self._shown}}", nl=False, err=True)
            self._shown = len(text)

    def answer(self) -> PersonAnswer | None:
        """None before there is one."""
        line = self._line(wait=False)
        if line is None:
            return None
        word = line.strip().lower()
        if word in ("q", "quit"):
            raise UserError("the calibration was ended.")
        if word in WORDS or not self.patient:
            return WORDS.get(word, PersonAnswer.DONE)
        self.tell(f"{cut(line.strip(), 20)!r} is no answer; press Enter when it is done, or type b, a, s or q.")
        return None

    def agrees(self, what: str) -> bool:
        """True if the person says yes. A script's line does, if it does not say no."""
        word = ""
        while word not in ("y", "yes", *NO):
            self._forget_typed()
            self.tell(f"{what} [yes or no]" if self.patient else f"{what} [Enter]")
            word = (self._line(wait=True) or "").strip().lower()
            if not self.patient:
                break
        return word not in NO

    def tell(self, what: str) -> None:
        self.close()
        tell(what)

    def close(self) -> None:
        """Take the live reading away: something else is printed next."""
        if self._shown:
            click.echo("\r" + " " * (self._shown + 2) + "\r", nl=False, err=True)
            self._shown = 0

    def _forget_typed(self) -> None:
        if self.patient:
            self._typed = b""
            system.forget_typed(sys.stdin)

    def _line(self, wait: bool) -> str | None:
        """The next line without its end, None where it has not come yet. Nothing is read ahead of the need."""
        while b"\n" not in self._typed:
            if not system.has_typed(sys.stdin, wait):
                return None
            data = os.read(sys.stdin.fileno(), 4096)
            if not (data or self._typed):
                raise UserError("the input ended in the middle of the questions.")
            self._typed += data or b"\n"  # the last line needs no end
        line, _, self._typed = self._typed.partition(b"\n")
        return line.decode("utf-8", "replace")
