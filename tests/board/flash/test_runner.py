"""Tools that run to their end, fail, hang or are interrupted: what is quoted of them, and that nothing stays behind."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from greywhale.base.errors import UserError
from greywhale.board.flash import runner
from greywhale.board.flash.runner import Tool, run_tool


def tool(*command: str, limit_s: float = 60.0) -> Tool:
    return Tool("the tool", list(command), dict(os.environ), Path(), limit_s)


def test_output_is_watched_and_returned() -> None:
    looks: list[None] = []
    code = "print('\\x1b[32mone\\x1b[0m'); print('two')"
    assert run_tool(tool(sys.executable, "-c", code), lambda: looks.append(None)) == "one\ntwo\n"
    assert looks


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("compiling\\nmain.cpp:3: error: no such thing\\n*** failed", "main.cpp:3: error: no such thing"),
        ("one\\nlast words", "last words"),
        ("", "it said nothing"),
    ],
)
def test_a_failed_tool_is_quoted_where_it_names_the_problem(output: str, words: str) -> None:
    with pytest.raises(UserError, match=rf"exit code 3: {words}"):
        run_tool(tool(sys.executable, "-c", f"print('{output}'); raise SystemExit(3)"), lambda: None)


def test_a_tool_that_is_not_there_is_named() -> None:
    with pytest.raises(UserError, match="/nowhere/tool: no such file"):
        run_tool(tool("/nowhere/tool"), lambda: None)


@pytest.mark.parametrize("end", ["hangs", "Ctrl-C"])
def test_a_tool_that_hangs_or_is_interrupted_is_ended(monkeypatch: pytest.MonkeyPatch, end: str) -> None:
    started: list[subprocess.Popen[bytes]] = []
    start: Any = subprocess.Popen

    def keep(*words: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(start(*words, **options))
        return started[-1]

    def look() -> None:
        if end == "Ctrl-C":
            raise KeyboardInterrupt

    monkeypatch.setattr(subprocess, "Popen", keep)
    waiting = tool(sys.executable, "-c", "import threading; threading.Event().wait()", limit_s=0.3)
    with pytest.raises((UserError, KeyboardInterrupt), match=r"0\.3 s" if end == "hangs" else None):
        run_tool(waiting, look)
    assert started[0].returncode == -signal.SIGTERM


def test_what_the_tool_started_ends_with_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where it does not hear that it shall end."""
    monkeypatch.setattr(runner, "GRACE_S", 0.0)
    started: list[int] = []
    told = tmp_path / "told"
    os.mkfifo(told)

    def interrupt() -> None:
        started.append(os.pidfd_open(int(told.read_text())))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_tool(tool("sh", "-c", f"trap '' TERM; sleep 1000 & echo $! > {told}; wait"), interrupt)
    try:
        assert select.select(started, [], [])[0] == started  # readable once the process has ended
    finally:
        os.close(started[0])
