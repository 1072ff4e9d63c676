"""Progress goes to stderr, also with --json: a bar on a terminal, lines elsewhere, nothing with --quiet."""

from __future__ import annotations

import contextlib
import io
import json
import os
import pty
import sys
from pathlib import Path

import click
import pytest

from greywhale.base.types import show_no_progress
from greywhale.cli import entry
from greywhale.cli.output import QUIET, progress
from tests.board.fake_board import FakeBoard

Captured = pytest.CaptureFixture[str]


def everything(seen: int) -> str:
    """All that was written to a terminal whose other end is closed by now; it comes in pieces of any size."""
    text = b""
    with contextlib.suppress(OSError):  # nothing more to come
        while piece := os.read(seen, 65536):
            text += piece
    os.close(seen)
    return text.decode()


def on_a_terminal(monkeypatch: pytest.MonkeyPatch, kind: str) -> str:
    seen, inner = pty.openpty()
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("TERM", kind)
    with os.fdopen(inner, "w", encoding="utf-8") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with progress() as report:
            assert report is not None
            report("tuning", 0.25, "cost 0.125")
            report("tuning", 0.5, "cost 0.0625")
    return everything(seen)


def test_a_terminal_sees_the_step_the_share_done_and_the_note(monkeypatch: pytest.MonkeyPatch) -> None:
    text = on_a_terminal(monkeypatch, "xterm")
    for words in ("tuning", "50 %", " so far", "cost 0.0625"):
        assert words in text


def test_a_terminal_that_cannot_move_its_cursor_gets_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    assert on_a_terminal(monkeypatch, "dumb") == " 0:00  tuning\r\n"


def told(monkeypatch: pytest.MonkeyPatch, **options: bool) -> str:
    """The output of two steps to a pipe."""
    pipe = io.StringIO()
    monkeypatch.setattr(sys, "stderr", pipe)
    with progress(**options) as report:
        assert report is not None
        report("reading", 0.0)
        report("writing", 0.0)
    return pipe.getvalue()


def test_a_pipe_is_told_each_step_but_not_those_of_a_verb_of_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch) == " 0:00  reading\n 0:00  writing\n"
    assert told(monkeypatch, brief=True) == ""


def test_quiet_shows_nothing() -> None:
    with click.Context(click.Command("tune")) as context:
        context.meta[QUIET] = True
        with progress() as report:
            assert report is show_no_progress


def test_a_reader_that_has_gone_ends_no_work(monkeypatch: pytest.MonkeyPatch) -> None:
    with open("/dev/full", "w", encoding="utf-8", buffering=1) as full:
        monkeypatch.setattr(sys, "stderr", full)
        with progress() as report:
            assert report is not None
            report("tuning", 0.0)
        monkeypatch.undo()
        with contextlib.suppress(OSError):
            full.close()


@pytest.mark.parametrize(
    ("before", "lines"),
    [
        ([], [" 0:00  starting the motors"]),
        (["-q"], []),
        (["-v"], ["greywhale.cli.output: starting the motors"]),
        (["-q", "-v"], ["greywhale.cli.output: starting the motors"]),
    ],
)
def test_stdout_is_one_object_and_the_steps_are_on_stderr_once(
    before: list[str], lines: list[str], tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    with FakeBoard() as board:
        out = tmp_path / "log.csv"
        arguments = ["record", "--enable", "-s", "0.1", "-o", str(out), "--port", board.port, "--json"]
        assert entry.run([*before, *arguments]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["log"] == str(out)
    assert [line for line in said.err.splitlines() if line.endswith("starting the motors")] == lines
    if before == ["-q"]:
        assert said.err == ""
