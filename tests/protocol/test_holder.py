"""The holder of a port is named as far as the system tells."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from greywhale.base import system
from greywhale.protocol import holder
from greywhale.protocol.holder import describe, holder_of, meddler, second_user_of
from tests.board.port_board import PortBoard, locked, opened


def test_who_has_locked_the_port_is_named_and_not_the_bench_that_made_it() -> None:
    with PortBoard() as board, locked(board.port) as process:
        assert (holder_of(board.port) or "").startswith(f"process {process} ({os.path.basename(sys.executable)} -c ")
        assert (holder_of(board.port) or "").endswith(f"{board.port})")


def test_who_has_it_open_without_a_lock_is_named() -> None:
    master, slave = os.openpty()
    port = os.ttyname(slave)
    with subprocess.Popen(["cat"], stdin=slave, stdout=subprocess.PIPE) as process:
        try:
            os.close(slave)
            os.write(master, b"there\n")
            assert process.stdout is not None
            assert process.stdout.readline() == b"there\n"  # it runs: the system knows its command by now
            assert holder_of(port) == f"process {process.pid} (cat)"
        finally:
            os.close(master)


def test_where_the_system_tells_nothing_nobody_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert holder_of(str(tmp_path / "ttyNONE")) is None
    assert holder_of(str(tmp_path)) is None
    with PortBoard() as board:
        monkeypatch.setattr(holder, "PROCESSES", tmp_path)
        assert holder_of(board.port) is None
        assert describe(4711) == "process 4711"


def test_the_second_user_is_neither_this_process_nor_who_made_the_port() -> None:
    with PortBoard() as board:
        mine = os.open(board.port, os.O_RDWR | os.O_NOCTTY)
        try:
            assert second_user_of(board.port) is None
            with opened(board.port) as process:
                assert (second_user_of(board.port) or "").startswith(f"process {process} (")
        finally:
            os.close(mine)
    make = "import os, sys; master, slave = os.openpty(); print(os.ttyname(slave), flush=True); input()"
    with subprocess.Popen([sys.executable, "-c", make], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as bench:
        assert bench.stdout is not None
        port = bench.stdout.readline().decode().strip()
        assert second_user_of(port) is None, "as a bench has it: both ends in a process of its own"
        with opened(port) as process:
            assert (second_user_of(port) or "").startswith(f"process {process} (")
        bench.communicate(b"\n")


def test_a_process_that_ends_while_all_are_looked_at_is_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    def without_the_first(look: Callable[..., Any]) -> Callable[..., Any]:
        def look_again(path: Any) -> Any:
            if os.fspath(path) == "/proc/1/fd":
                raise FileNotFoundError(errno.ENOENT, "ended", path)
            return look(path)

        return look_again

    monkeypatch.setattr(os, "scandir", without_the_first(os.scandir))
    monkeypatch.setattr(os, "listdir", without_the_first(os.listdir))
    with PortBoard() as board, opened(board.port) as process:
        assert (second_user_of(board.port) or "").startswith(f"process {process} (")


@pytest.mark.parametrize(
    ("program", "udev", "told"),
    [
        ("ModemManager", "", "`greywhale udev`"),
        ("ModemManager", "E:ID_MM_DEVICE_IGNORE=1\n", None),
        ("ModemManager", "E:ID_MM_PORT_IGNORE=1\n", None),
        ("ModemManager", "E:ID_MM_CANDIDATE=1\n", "`greywhale udev`"),
        ("brltty", "E:ID_MM_DEVICE_IGNORE=1\n", "brltty"),
        ("bash", "", None),
    ],
)
def test_a_program_that_opens_ports_of_its_own_accord_is_named_unless_udev_keeps_it_away(
    program: str, udev: str, told: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "4711").mkdir()
    (tmp_path / "4711" / "comm").write_text(f"{program}\n")
    monkeypatch.setattr(holder, "PROCESSES", tmp_path)
    monkeypatch.setattr(holder, "UDEV", tmp_path)
    with PortBoard() as board:
        assert meddler(board.port) is None, "none of them looks at a pseudo-terminal"
        major, minor = system.numbers(os.stat(board.port).st_rdev)
        (tmp_path / f"c{major}:{minor}").write_text(udev)
        monkeypatch.setattr(system, "pseudo_terminal_of", lambda device: None)
        found = meddler(board.port)
    assert (found is None) == (told is None)
    assert (told or "") in (found or "")
