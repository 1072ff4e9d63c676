"""`record --episodes` as a person at a terminal of 80 columns meets it, by keys, and as a script does."""

from __future__ import annotations

import io
import json
import os
import re
import select
import sys
import termios
from pathlib import Path

import pytest

from greywhale.base import system
from greywhale.cli import entry
from greywhale.cli.keys import PersonAtKeys
from greywhale.files.log import read_log
from greywhale.protocol.schema import State
from tests.board.fake_board import FakeBoard
from tests.cli.test_progress import everything

TASK = 'Stapel die Würfel, "klein" auf groß'
RIGHT, LEFT, ESC = b"\x1b[C", b"\x1b[D", b"\x1b"


class BoardWithPerson(FakeBoard):
    """A person presses a key every 100 ticks of following, and each is there before the board's next tick."""

    def __init__(self, keyboard: int, typed: io.TextIOBase, keys: list[bytes]) -> None:
        super().__init__()
        self._keyboard, self._typed, self.keys = keyboard, typed, keys
        self._next_tick = 0

    def live(self) -> None:
        super().live()
        if self.state is State.FOLLOWING and self.keys and self.tick >= self._next_tick:
            self._next_tick = self.tick + 100
            os.write(self._keyboard, self.keys.pop(0))
            select.select([self._typed], [], [])


def test_keys_begin_end_and_discard_and_the_terminal_is_as_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    keyboard, terminal = os.openpty()
    screen, shows = os.openpty()
    folder = Path("cubes")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(system, "in_foreground", lambda: True)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("LINES", "24")
    monkeypatch.setenv("TERM", "xterm")
    keys = [b"x", b"\n", b" ", RIGHT, LEFT, b" ", b"\x7f", b"\n", RIGHT, b"d", b" ", b"\n", b"\x1b[A", ESC]
    with open(terminal, encoding="utf-8") as typed, BoardWithPerson(keyboard, typed, keys) as board:
        monkeypatch.setattr("sys.stdin", typed)
        monkeypatch.setattr("sys.stderr", open(shows, "w", encoding="utf-8"))  # noqa: SIM115 (closed below)
        before = termios.tcgetattr(typed)
        arguments = ["--task", TASK, "--out", str(folder), "--enable", "--port", board.port, "--json"]
        assert entry.run(["record", "--episodes", "5", *arguments]) == 0
        assert termios.tcgetattr(typed) == before
        assert (board.keys, board.state) == ([], State.DISABLED)
        sys.stderr.close()
    os.close(keyboard)
    answer = json.loads(capsys.readouterr().out)
    assert [Path(one["log"]).name for one in answer["episodes"]] == ["episode_000.csv", "episode_001.csv"]
    assert (answer["task"], answer["discarded"]) == (TASK, 3)
    assert sorted(folder.iterdir()) == [Path(one["log"]) for one in answer["episodes"]]
    for one in answer["episodes"]:
        log = read_log(one["log"])
        assert (log.origin.task, len(log.time)) == (TASK, one["samples"])
        assert one["duration_s"] == pytest.approx(0.1, abs=0.005)
    lines = re.split(r"[\r\n]+", everything(screen))
    shown = [re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", line) for line in lines]
    assert max(map(len, shown)) <= 80
    kept, discarded = ([line for line in shown if line.endswith(word)] for word in ("s, kept.", ": discarded."))
    assert (len(kept), len(discarded)) == (3, 3)
    assert all(line.startswith("cubes/episode_00") for line in kept + discarded), "each has a line of its own"
    steps = [
        PersonAtKeys(str).step(name, running)
        for name, running in (("episode_000.csv", True), ("episode_000.csv", False), ("", False))
    ]
    assert max(map(len, steps)) <= 80
    assert all(word in step for word, step in zip(("ends it", "Enter begins", "Enter ends"), steps, strict=True))


def test_a_script_records_episodes_of_a_fixed_length(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "new" / "folder"
    with FakeBoard() as board:
        arguments = ["--out", str(folder), "--seconds", "0.3", "--port", board.port]
        assert entry.run(["record", "--episodes", "2", "--task", TASK, *arguments]) == 0
    said = capsys.readouterr().out
    for number in range(2):
        log = folder / f"episode_00{number}.csv"
        assert f"{log}: 300 samples, 0.3 s." in said
        assert (set(read_log(log).state), read_log(log).origin.task) == ({"disabled"}, TASK)
    assert "2 episodes kept." in said


@pytest.mark.parametrize(
    ("more", "things"),
    [
        ([], "--task"),
        (["--task", " "], "--task"),
        (["--task", "a", "--poses", "3"], "--episodes --poses"),
        (["--task", "a", "--reconnect"], "--episodes --reconnect"),
        (["--task", "a", "--overwrite"], "--episodes --overwrite"),
        (["--task", "a", "--out", __file__], "folder file test_episodes.py"),
    ],
)
def test_what_makes_no_sense_is_refused_before_a_port_is_opened(
    more: list[str], things: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert entry.run(["record", "--episodes", "2", "--port", "none", *more]) == 2
    said = capsys.readouterr().err
    assert all(thing in said for thing in things.split()), said
