"""The keys by which a person at this terminal begins, ends and discards episodes: LeRobot's arrows among them."""

from __future__ import annotations

import contextlib
import re
import sys
from collections import deque
from collections.abc import Callable, Iterator

import click

from greywhale.base import system
from greywhale.base.errors import printable
from greywhale.board.episodes import Person, Wish
from greywhale.cli import output

# An arrow is several letters: of two kinds of terminals, and of Windows.
_RIGHT, _LEFT = ("\x1b[C", "\x1bOC", "\xe0M"), ("\x1b[D", "\x1bOD", "\xe0K")
_KEYS = {
    Wish.NEXT: ("\r", "\n", " ", *_RIGHT),
    Wish.DISCARD: ("\x7f", "\b", "d", "D", *_LEFT),
    Wish.END: ("\x1b", "q", "Q", "\x04"),
}
_WISHES = {key: wish for wish, keys in _KEYS.items() for key in keys}
_KEY = re.compile(r"\x1b\[[0-9;]*[A-Za-z~]|\x1bO.|\xe0.|.", re.DOTALL)


class PersonAtKeys(Person):
    """Asks on stderr, and takes a key for an answer."""

    def __init__(self, pressed: Callable[[], str]) -> None:
        self._pressed = pressed
        self._wishes: deque[Wish] = deque()

    def wish(self, running: bool) -> Wish | None:
        self._wishes.extend(_WISHES[key] for key in _KEY.findall(self._pressed()) if key in _WISHES)
        return self._wishes.popleft() if self._wishes else None

    def tell(self, sentence: str) -> None:
        click.echo(printable(sentence), file=sys.stderr)  # which is above the running step while that is shown

    def step(self, name: str, running: bool) -> str:
        if running:
            return f"{name} runs: Enter ends it, Backspace discards it, q ends all"
        if not name:
            return "all are there: Enter ends, Backspace discards the last"
        return f"next {name}: Enter begins, Backspace discards the last, q ends"


@contextlib.contextmanager
def person_at_hand() -> Iterator[Person | None]:
    """A person at the keys of this terminal; None where nobody is there, or a page shows this."""
    if output.watcher is not None or not (sys.stdin.isatty() and sys.stderr.isatty() and system.in_foreground()):
        yield None
        return
    with system.pressed_keys(sys.stdin) as pressed:
        yield PersonAtKeys(pressed)
