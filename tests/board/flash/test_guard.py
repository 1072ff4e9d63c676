"""A tool whose host is killed goes on, but not without its port and not for ever."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from greywhale.board.flash import guard

FOR_EVER = "sleep 1000 & echo $$ $!; wait"


class Orphan:
    """A guarded shell command that has begun, and all of whose processes say when they have ended."""

    def __init__(self, command: str, port: Path | str = "", limit_s: float = 1000.0) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-I", "-S", guard.__file__, str(limit_s), str(port), "sh", "-c", command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
        )
        assert self.process.stdout is not None
        self.ends = [os.pidfd_open(int(number)) for number in self.process.stdout.readline().split()]

    def lose_host(self) -> None:
        assert self.process.stdin is not None
        self.process.stdin.close()

    def running(self, wait_s: float | None = None) -> int:
        """How many of them have not ended after this time, if any; else this waits for the end of all."""
        left = list(self.ends)
        while left and (ended := select.select(left, [], [], wait_s)[0]):
            left = [one for one in left if one not in ended]
        return len(left)

    def close(self) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            assert stream is not None
            stream.close()
        for end in self.ends:
            os.close(end)


@pytest.fixture
def port(tmp_path: Path) -> Path:
    path = tmp_path / "port"
    path.touch()
    return path


@contextlib.contextmanager
def orphan(command: str, port: Path | str = "", limit_s: float = 1000.0) -> Iterator[Orphan]:
    made = Orphan(command, port, limit_s)
    try:
        yield made
    finally:
        made.close()


def test_a_tool_goes_on_without_its_host(port: Path) -> None:
    told = port.with_name("told")
    os.mkfifo(told)
    with orphan(f"echo $$; read word < {told}; exit 3", port) as made:
        made.lose_host()
        assert made.running(3 * guard.LOOK_EVERY_S) == 1
        told.write_text("go\n", encoding="utf-8")
        assert made.process.wait() == 3


def test_a_tool_without_its_host_ends_when_its_port_goes_away(port: Path) -> None:
    with orphan(FOR_EVER, port) as made:
        made.lose_host()
        assert made.running(2 * guard.LOOK_EVERY_S) == 2
        port.unlink()
        assert made.running() == 0


def test_another_port_of_the_same_name_is_another_port(port: Path) -> None:
    with orphan(FOR_EVER, port) as made:
        made.lose_host()
        later = port.with_name("later")
        later.touch()
        later.rename(port)
        assert made.running() == 0


def test_a_tool_without_its_host_ends_after_its_limit() -> None:
    with orphan(FOR_EVER, limit_s=0.3) as made:
        made.lose_host()
        assert made.running() == 0


def test_a_tool_with_its_host_keeps_running_without_its_port(port: Path) -> None:
    """The host itself looks after the port then, and says so."""
    with orphan(FOR_EVER, port, limit_s=0.1) as made:
        port.unlink()
        assert made.running(3 * guard.LOOK_EVERY_S) == 2


@pytest.mark.parametrize(("ending", "code"), [("exit 0", 0), ("exit 5", 5), ("kill -TERM $$", -15), ("kill -9 $$", -9)])
def test_the_guard_ends_as_the_tool_does(ending: str, code: int) -> None:
    command = [sys.executable, "-I", "-S", guard.__file__, "1000", "", "sh", "-c", ending]
    assert subprocess.run(command, stdin=subprocess.PIPE).returncode == code
