"""Tools that run to their end, fail, hang or are interrupted: what is quoted of them, and that nothing stays behind."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
from typing import Any

import pytest

from greywhale.base.errors import UserError
from greywhale.board.flash import runner
from greywhale.board.flash.runner import Tool, run_tool


def tool(*command: str, limit_s: float = 60.0) -> Tool:
    return Tool("the tool", list(command), dict(os.environ), limit_s)


def test_output_is_watched_and_returned() -> None:
    seen: list[str] = []
    text = run_tool(tool(sys.executable, "-c", "print('\\x1b[32mone\\x1b[0m'); print('two')"), seen.append)
    assert text == "one\ntwo\n"
    assert seen


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("compiling\\nmain.cpp:3: error: no such thing\\n*** failed", "main.cpp:3: error: no such thing"),
        ("one\\nlast words", "last words"),
        ("", "it said nothing"),
        ("OS error: ioctl(TIOCMGET): Inappropriate ioctl for device", "it said nothing"),
        ("OS error: ioctl(TIOCMGET): x\\navrdude error: timeout\\navrdude done.  Thank you.", "avrdude error: timeout"),
    ],
)
def test_a_failed_tool_is_quoted_where_it_names_the_problem(output: str, words: str) -> None:
    with pytest.raises(UserError, match=rf"exit code 3: {words}"):
        run_tool(tool(sys.executable, "-c", f"print('{output}'); raise SystemExit(3)"), lambda text: None)


def test_a_tool_that_is_not_there_is_named() -> None:
    with pytest.raises(UserError, match="/nowhere/tool: No such file"):
        run_tool(tool("/nowhere/tool"), lambda text: None)


@pytest.mark.parametrize("end", ["hangs", "Ctrl-C"])
def test_a_tool_that_hangs_or_is_interrupted_is_ended(monkeypatch: pytest.MonkeyPatch, end: str) -> None:
    started: list[subprocess.Popen[bytes]] = []
    start: Any = subprocess.Popen

    def keep(*words: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(start(*words, **options))
        return started[-1]

    def look(text: str) -> None:
        if end == "Ctrl-C":
            raise KeyboardInterrupt

    monkeypatch.setattr(subprocess, "Popen", keep)
    waiting = tool(sys.executable, "-c", "import threading; threading.Event().wait()", limit_s=0.3)
    with pytest.raises((UserError, KeyboardInterrupt), match=r"0\.3 s" if end == "hangs" else None):
        run_tool(waiting, look)
    assert started[0].returncode == -signal.SIGTERM


def test_what_the_tool_started_ends_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where it does not hear that it shall end."""
    monkeypatch.setattr(runner, "GRACE_S", 0.0)
    started: list[int] = []

    def interrupt(text: str) -> None:
        if text.endswith("\n"):
            started.append(os.pidfd_open(int(text)))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_tool(tool("sh", "-c", "trap '' TERM; sleep 1000 & echo $!; wait"), interrupt)
    try:
        assert select.select(started, [], [])[0] == started  # readable once the process has ended
    finally:
        os.close(started[0])
