"""Who has a port: named as far as the system tells."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from greywhale.protocol import holder
from greywhale.protocol.holder import describe, holder_of
from tests.board.port_board import PortBoard, locked


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
