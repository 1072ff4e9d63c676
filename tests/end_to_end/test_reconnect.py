"""A bench whose port is taken away while a log is recorded, and given back under the same name."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.demo import BenchProcess
from greywhale.files.log import read_log
from greywhale.protocol.schema import State, StopReason


def wait_for_rows(log: Path, host: subprocess.Popen[str]) -> None:
    """Until the recording has written its first rows."""
    unfinished = log.with_name(f"{log.stem}.unfinished{log.suffix}")
    while not unfinished.exists():
        assert host.poll() is None, host.communicate()
        time.sleep(0.05)


@pytest.mark.slow
def test_a_log_goes_on_when_its_port_is_given_back(start_bench: Callable[..., BenchProcess], tmp_path: Path) -> None:
    name, out = tmp_path / "board", tmp_path / "log.csv"
    options = ("--speed", "1", "--link", str(name))
    first = start_bench(*options)
    command = [sys.executable, "-m", "greywhale", "-q", "record", "--reconnect", "-s", "20", "--every", "10", "--json"]
    with subprocess.Popen(
        [*command, "-o", str(out), "--port", str(name)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as host:
        wait_for_rows(out, host)
        first.close()
        start_bench(*options)
        said, problem = host.communicate(timeout=120)
    assert (host.returncode, problem) == (0, "")
    told, log = json.loads(said), read_log(out)
    ((begin, length),) = told["gaps_s"]
    assert log.complete
    assert log.time[-1] == pytest.approx(20.0, abs=0.1)
    assert np.all(np.diff(log.time[log.time > begin + length + 0.1]) < 0.05), "and from then on without a gap"
    assert set(log.state) == {"disabled"}
    with Device(str(name), restart=False) as device:
        status = device.status()
        assert (status.state, status.stop_reason) == (State.DISABLED, StopReason.RESET), "no motor was ever on"
