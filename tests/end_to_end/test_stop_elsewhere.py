"""`greywhale stop` while another process leads the arm on the bench: motors off at once, the board not restarted."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.cli.entry import run
from greywhale.cli.story import BenchProcess
from greywhale.files.leader import save_leader
from greywhale.files.log import read_log
from greywhale.files.trajectory import Trajectory
from greywhale.protocol.schema import State

pytestmark = pytest.mark.slow
Start = Callable[..., BenchProcess]
# What a verb is started in, beside its terminal.
CRON = {"PATH": "/usr/bin:/bin", "HOME": "/"}
NOTEBOOK = {**CRON, "XDG_RUNTIME_DIR": "/nowhere", "TMPDIR": "/var/tmp"}


def greywhale(*arguments: str, env: dict[str, str] | None = None) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "greywhale", *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env)


@pytest.mark.parametrize(
    ("board", "verb", "env"),
    [("mega", ("record", "--enable", "--seconds", "3600"), CRON), ("nano", ("replay",), NOTEBOOK)],
    ids=["record", "replay"],
)
def test_what_runs_ends_with_a_whole_log_whatever_the_environment_of_the_stop(
    start_bench: Start, tmp_path: Path, board: str, verb: tuple[str, ...], env: dict[str, str]
) -> None:
    bench = start_bench(board=board)
    log, rest = tmp_path / "log.csv", tmp_path / "rest.csv"
    save_leader(rest, Trajectory(np.array([0.0, 3600.0]), np.zeros((2, 4))))
    motion = [str(rest)] if verb == ("replay",) else []
    with greywhale(*verb, *motion, "--out", str(log), "--port", bench.port) as host:
        while not bench.command("status")["motors_enabled"]:
            assert host.poll() is None, host.communicate()
        resets = bench.command("status")["resets"]
        with greywhale("stop", "--port", bench.port, "--json", env=env) as stop:
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


def test_a_fault_is_cleared_without_a_restart(
    start_bench: Start, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench = start_bench()
    with Device(bench.port) as device, pytest.raises(UserError, match="potentiometer 2"):
        record(device, tmp_path / "log.csv", 60.0, enable=True, progress=lambda *_: break_a_wire(bench))
    bench.command("pot follower 2 connected")
    resets = bench.command("status")["resets"]
    with Device(bench.port, restart=False) as device:
        assert device.status().state is State.FAULT
    assert run(["stop", "--clear-fault", "--port", bench.port, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"port": bench.port, "state": "disabled", "restarted": False}
    assert bench.command("status")["resets"] == resets
    with Device(bench.port) as device:
        assert device.restarted
    assert bench.command("status")["resets"] == resets + 1


def break_a_wire(bench: BenchProcess) -> None:
    bench.command("pot follower 2 open")
