"""The person at the terminal: early keys are no answer, words go back and forth, and a script's lines all count."""

from __future__ import annotations

import os
import pty
import select
from collections.abc import Callable, Iterator, Sequence

import pytest

from greywhale.base.errors import UserError
from greywhale.board.calibrate import PersonAnswer
from greywhale.cli.person import Terminal

Typing = Callable[[bytes], None]


@pytest.fixture
def typed(monkeypatch: pytest.MonkeyPatch) -> Iterator[Typing]:
    """Types at the terminal that is the standard input now; it returns when the line has arrived."""
    keyboard, inner = pty.openpty()
    with os.fdopen(inner, encoding="utf-8") as stdin:
        monkeypatch.setattr("sys.stdin", stdin)

        def type_line(line: bytes) -> None:
            os.write(keyboard, line)
            select.select([stdin], [], [])

        yield type_line
    os.close(keyboard)


@pytest.fixture
def piped(monkeypatch: pytest.MonkeyPatch) -> Iterator[Typing]:
    """Lines of a script, through a pipe."""
    out, into = os.pipe()
    with os.fdopen(out, encoding="utf-8") as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        yield lambda line: None if os.write(into, line) else os.close(into)


def test_what_was_typed_before_a_question_is_no_answer(typed: Typing) -> None:
    person = Terminal()
    typed(b"\nb\n\n")
    person.ask("Turn it.")
    assert person.answer() is None
    typed(b"\n")
    assert person.answer() is PersonAnswer.DONE
    assert person.answer() is None


def test_a_scripts_lines_are_answers_whenever_they_were_written(piped: Typing) -> None:
    piped(b"\nb\nanything\nlast")
    person = Terminal()
    assert not person.patient
    for expected in (PersonAnswer.DONE, PersonAnswer.BACK, PersonAnswer.DONE):
        person.ask("Turn it.")
        assert person.answer() is expected
    assert person.answer() is None
    piped(b"")
    assert person.answer() is PersonAnswer.DONE
    with pytest.raises(UserError, match="the input ended in the middle of the questions"):
        person.answer()


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        (b"b\n", PersonAnswer.BACK),
        (b" Back \n", PersonAnswer.BACK),
        (b"a\n", PersonAnswer.AGAIN),
        (b"s\n", PersonAnswer.SKIP),
        (b"y\n", PersonAnswer.DONE),
    ],
)
def test_words_are_answers(typed: Typing, line: bytes, answer: PersonAnswer) -> None:
    person = Terminal()
    assert person.patient
    person.ask("Turn it.")
    typed(line)
    assert person.answer() is answer


def test_a_word_that_is_none_is_told_and_not_taken_for_done(typed: Typing, capsys: pytest.CaptureFixture[str]) -> None:
    person = Terminal()
    person.ask("Turn it.")
    typed(b"bakc\n")
    assert person.answer() is None
    assert "'bakc' is no answer; press Enter when it is done, or type b, a, s or q." in capsys.readouterr().err


def test_q_ends_it_all(typed: Typing) -> None:
    person = Terminal()
    person.ask("Turn it.")
    typed(b"q\n")
    with pytest.raises(UserError, match="the calibration was ended"):
        person.answer()


class Impatient(Terminal):
    """Types a line as soon as a question is there, and one before that."""

    def __init__(self, typing: Typing, lines: Sequence[bytes]) -> None:
        super().__init__()
        self.left = list(lines)
        self._typing = typing
        typing(b"yes\n")

    def tell(self, what: str) -> None:
        self._typing(self.left.pop(0))


@pytest.mark.parametrize(
    ("lines", "agrees"),
    [((b"yes\n",), True), ((b"\n", b"maybe\n", b"Y\n"), True), ((b"\n", b"no\n"), False), ((b"q\n",), False)],
)
def test_only_a_yes_after_the_question_agrees(typed: Typing, lines: Sequence[bytes], agrees: bool) -> None:
    person = Impatient(typed, lines)
    assert person.agrees("Store this?") is agrees
    assert person.left == []


@pytest.mark.parametrize(("line", "agrees"), [(b"\n", True), (b"yes\n", True), (b"no\n", False)])
def test_a_scripts_line_agrees_if_it_does_not_say_no(piped: Typing, line: bytes, agrees: bool) -> None:
    piped(line)
    assert Terminal().agrees("Store this?") is agrees


def test_a_live_reading_leaves_no_letter_behind(
    piped: Typing, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "24")
    person = Terminal()
    for live in ("leader potentiometer 0 reads 511", "short"):
        person.show(live)
    person.tell("Done.")
    person.close()
    shown = capsys.readouterr().err
    assert shown == f"\r  leader potentiometer \r  short{'':16}\r{'':7}\rDone.\n"
