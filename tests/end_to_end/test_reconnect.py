"""A bench whose port is taken away while a log is recorded, and given back under the same name."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.cli.story import BenchProcess
from greywhale.files.log import read_log
from greywhale.protocol.schema import State, StopReason

SECONDS = 30


def wait_for_rows(log: Path, bench: BenchProcess, host: subprocess.Popen[str]) -> None:
    """Until the recording has written its first rows."""
    unfinished = log.with_name(f"{log.stem}.unfinished{log.suffix}")
    while not unfinished.exists():
        assert host.poll() is None, host.communicate()
        bench.command("status")  # takes a moment


@pytest.mark.slow
def test_a_log_goes_on_when_its_port_is_given_back(start_bench: Callable[..., BenchProcess], tmp_path: Path) -> None:
    """The first bench lives in real time, so that the log is not full before its port goes; the next one hurries."""
    name, other, out = tmp_path / "board", tmp_path / "other", tmp_path / "log.csv"
    first = start_bench("--link", str(name), "--speed", "1")
    start_bench("--link", str(other))
    options = ("--reconnect", "--seconds", str(SECONDS), "--every", "10", "--json")
    command = [sys.executable, "-m", "greywhale", "-q", "record", *options]
    with subprocess.Popen(
        [*command, "-o", str(out), "--port", str(name)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as host:
        wait_for_rows(out, first, host)
        other.replace(name)
        first.close()
        said, problem = host.communicate()
    assert (host.returncode, problem) == (0, "")
    told, log = json.loads(said), read_log(out)
    ((begin, length),) = told["gaps_s"]
    assert log.complete
    assert log.time[-1] == pytest.approx(SECONDS, abs=0.1)
    assert np.all(np.diff(log.time[log.time > begin + length + 0.1]) < 0.05), "and from then on without a gap"
    assert set(log.state) == {"disabled"}
    with Device(str(name), restart=False) as device:
        status = device.status()
        assert (status.state, status.stop_reason) == (State.DISABLED, StopReason.RESET), "no motor was ever on"
