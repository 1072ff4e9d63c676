"""A verb that runs on does something at each Enter, and never reads what is typed for another program."""

from __future__ import annotations

import os
import queue
import sys
import threading
from collections.abc import Iterator

import pytest

from greywhale.base import system
from greywhale.cli import person

PATIENCE_S = 60.0


@pytest.fixture
def keyboard(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """The end at which keys arrive that a person presses at this process's terminal."""
    keys, terminal = os.openpty()
    with open(terminal, encoding="utf-8") as typed:
        monkeypatch.setattr("sys.stdin", typed)
        yield keys
    os.close(keys)


def test_each_enter_counts_until_the_input_ends(keyboard: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(system, "in_foreground", lambda: True)
    done: queue.Queue[str] = queue.Queue()
    thread = threading.Thread(target=person.on_enter, args=(lambda: done.put("done"),))
    thread.start()
    for key in (b"\n", b"words\n", b"\n"):
        os.write(keyboard, key)
        assert done.get(timeout=PATIENCE_S) == "done"
    os.write(keyboard, b"\x04")
    thread.join(PATIENCE_S)
    assert not thread.is_alive()
    assert done.empty()


def test_what_is_typed_while_another_program_has_the_terminal_is_left(
    keyboard: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = iter([False, False, True, True])
    unread: list[bool] = []

    def in_foreground() -> bool:
        unread.append(system.has_typed(typed, wait=False))
        return next(seen)

    typed = sys.stdin
    monkeypatch.setattr(person, "LOOK_AGAIN_S", 0.0)
    monkeypatch.setattr(system, "in_foreground", in_foreground)
    os.write(keyboard, b"\n")

    def act() -> None:
        raise EOFError

    with pytest.raises(EOFError):
        person.on_enter(act)
    assert unread == [True, True, True]
