"""`greywhale stop` while another process leads the arm on the bench: motors off at once, the board not restarted."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.demo import BenchProcess
from greywhale.files.log import read_log

Start = Callable[..., BenchProcess]


def greywhale(*arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "greywhale", *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.mark.timeout(120)
@pytest.mark.parametrize("verb", [("record", "--enable", "--seconds", "600"), ("replay",)], ids=["record", "replay"])
def test_what_runs_ends_with_a_whole_log(
    start_bench: Start, tmp_path: Path, leader_file: Path, verb: tuple[str, ...]
) -> None:
    bench = start_bench("--speed", "1")
    log = tmp_path / "log.csv"
    motion = [str(leader_file)] if verb == ("replay",) else []
    with greywhale(*verb, *motion, "--out", str(log), "--port", bench.port) as host:
        while not bench.command("status")["motors_enabled"]:
            assert host.poll() is None, host.communicate()
        resets = bench.command("status")["resets"]
        with greywhale("stop", "--port", bench.port, "--json") as stop:
            answer, _ = stop.communicate()
        after = bench.command("status")
        _, said = host.communicate()
    assert stop.returncode == 0, answer
    assert json.loads(answer) == {"port": bench.port, "state": "disabled", "ended": host.pid}
    assert not after["motors_enabled"]
    assert after["resets"] == resets
    assert host.returncode == 130
    assert "stopped with `greywhale stop` from another terminal" in said
    assert not log.exists() or not read_log(log).complete
