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
from tests.support.strangers import plant, ran


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
        (
            "avrdude OS error: ioctl(TIOCMGET): Inappropriate ioctl for device\\n"
            "avrdude error: timeout communicating with programmer\\navrdude done.  Thank you.",
            "avrdude error: timeout communicating with programmer; no bootloader answered: check --board and the "
            "cable, press the board's reset button and try again.",
        ),
    ],
)
def test_a_failed_tool_is_quoted_where_it_names_the_problem(output: str, words: str) -> None:
    with pytest.raises(UserError) as caught:
        run_tool(tool(sys.executable, "-c", f"print('{output}'); raise SystemExit(3)"), lambda text: None)
    assert caught.value.message == f"the tool failed with exit code 3: {words}"


def test_a_tool_that_is_not_there_is_named() -> None:
    with pytest.raises(UserError, match=r"the tool cannot be started: /nowhere/tool: No such file or directory\.$"):
        run_tool(tool("/nowhere/tool"), lambda text: None)


def test_a_tool_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []
    real = subprocess.Popen

    def start(*args: object, **options: object) -> subprocess.Popen[bytes]:
        started.append(real(*args, **options))  # type: ignore[call-overload]
        return started[-1]

    monkeypatch.setattr(subprocess, "Popen", start)
    with pytest.raises(UserError, match=r"has not ended after 0\.3 s; reset the board"):
        run_tool(
            tool(sys.executable, "-c", "import threading; threading.Event().wait()", limit_s=0.3), lambda text: None
        )
    assert started[0].returncode == -signal.SIGTERM


def test_a_tool_imports_nothing_from_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """PlatformIO, as it is called where a firmware is built."""
    plant(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert "PlatformIO" in run_tool(tool(sys.executable, "-m", "platformio", "--version"), lambda text: None)
    assert ran(tmp_path) == set()


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


def test_ctrl_c_ends_the_tool_too(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[subprocess.Popen[bytes]] = []
    start: Any = subprocess.Popen

    def keep(*words: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(start(*words, **options))
        return started[-1]

    monkeypatch.setattr(subprocess, "Popen", keep)

    def interrupt(text: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_tool(tool(sys.executable, "-c", "import threading; threading.Event().wait()"), interrupt)
    assert started[0].returncode == -signal.SIGTERM
