"""No word is cut at a terminal's border, and what a pipe gets is not broken at all."""

from __future__ import annotations

import io
import os
import pty
import sys
import termios
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from greywhale.cli import entry
from greywhale.cli.wrapping import fit, wrap
from tests.cli.test_progress import everything

TEXTS = st.text(alphabet="ab`-/ \n²", max_size=200)


@given(TEXTS, st.integers(8, 60), st.integers(0, 7))
@example("run `a b and so on", 8, 0)
def test_words_stay_whole_and_none_is_lost(text: str, width: int, hang: int) -> None:
    broken = wrap(text, width, hang)
    assert broken.split() == text.split()
    for line in broken.split("\n"):
        assert len(line) <= width or len(line.split()) <= 1


def test_a_command_is_copied_from_one_line_where_one_can_hold_it() -> None:
    text = "it is not installed; install it (Debian: `sudo apt-get install python3`) and try again."
    assert wrap(text, 40).split("\n") == [
        "it is not installed; install it (Debian:",
        "`sudo apt-get install python3`) and try",
        "again.",
    ]
    assert wrap(text, 20).split("\n")[2:4] == ["`sudo apt-get", "install python3`)"]


def seen_on(width: int, monkeypatch: pytest.MonkeyPatch, stream: str, arguments: list[str]) -> str:
    """The output of a command on a terminal of that width."""
    seen, inner = pty.openpty()
    termios.tcsetwinsize(inner, (24, width))
    with os.fdopen(inner, "w", encoding="utf-8") as terminal:
        monkeypatch.setattr(sys, stream, terminal)
        entry.run(arguments)
    return everything(seen).replace("\r\n", "\n")


@pytest.mark.parametrize("width", [40, 80])
def test_an_error_is_broken_on_a_terminal_alone(
    width: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("log.csv").write_text("time_s\n")
    assert entry.run(["evaluate", "log.csv", "--picture", "p.bmp"]) == 2
    assert capsys.readouterr().err == "greywhale: p.bmp: pictures end in .png, .svg, .pdf.\n"
    arguments = ["upload", "x", "--port", "y", "--nonsense"]
    assert entry.run(arguments) == 2
    whole = capsys.readouterr().err
    assert len(whole) > 40
    text = seen_on(width, monkeypatch, "stderr", arguments)
    assert max(map(len, text.splitlines())) <= width
    assert text.split() == whole.split()


def test_a_terminal_that_does_not_say_its_width_is_a_usual_one() -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    assert max(map(len, fit(" ".join(["word"] * 60), Terminal()).split("\n"))) == 79
