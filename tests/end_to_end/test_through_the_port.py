"""The bench in a process of its own, the host's own Device on its serial port: nothing between them but bytes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.board.upload import upload_controller
from greywhale.cli.story import BenchProcess
from greywhale.files.log import read_log
from greywhale.measure import evaluate
from greywhale.protocol.schema import State
from greywhale_sim.__main__ import main
from greywhale_sim.serve import ServeOptions, serve
from tools import ROOT

TABLES = ROOT / "shared" / "fuzzy_tables"

Start = Callable[..., BenchProcess]


@pytest.mark.slow
def test_upload_record_evaluate(start_bench: Start, tmp_path: Path) -> None:
    bench = start_bench()
    with Device(bench.port) as device:
        uploaded = upload_controller(device, TABLES / "table_8.toml")
        assert uploaded.changed
        recording = record(device, tmp_path / "log.csv", 2.0, enable=True)
        assert device.status().state is State.DISABLED
    assert not bench.command("status")["motors_enabled"]
    assert (recording.rows, recording.dropped) == (2000, 0)
    log = read_log(tmp_path / "log.csv")
    assert log.complete
    assert log.origin.param_crc == uploaded.param_crc
    assert set(log.state) == {"following"}
    measures = evaluate(log)
    for joint in measures.joints:
        assert 1e-7 < joint.mse < 0.02, "following, but not perfectly"
    assert abs(log.voltage).max() > 1.0


HOST_THAT_DIES = """
import sys
from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.stream import stream
with Device(sys.argv[1]) as device:
    samples = stream(device, 1)
    device.enable(500)
    said = ""
    for received in samples:
        state = received.sample.state.key
        if state in ("following", "fault") and state != said:
            said = state
            print(state, flush=True)
"""


@pytest.mark.slow
def test_a_killed_host_leaves_no_motor_on_and_a_bench_that_ends_no_link(start_bench: Start, tmp_path: Path) -> None:
    link = tmp_path / "bench"
    bench = start_bench("--link", str(link))
    assert bench.port == str(link)
    assert link.is_symlink()
    with pytest.raises(UserError, match="not a bench command"):
        bench.command("explode")
    with subprocess.Popen([sys.executable, "-c", HOST_THAT_DIES, bench.port], stdout=subprocess.PIPE) as host:
        try:
            assert host.stdout is not None
            assert host.stdout.readline() == b"following\n"
            before = bench.command("status")
        finally:
            host.kill()
    assert before["motors_enabled"]
    killed = bench.command("status")["time_s"]
    while (now := bench.command("status"))["time_s"] < killed + 0.6:
        pass  # simulated time goes on, in real time now that nobody is connected
    assert not now["motors_enabled"]
    assert now["resets"] == before["resets"], "off by its own lease, not by a reset"
    bench.close()
    assert bench.exit_code == 0
    assert not link.is_symlink()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--leader", "nowhere.csv"), "nowhere.csv: cannot be read"),
        (("--arm", "nowhere.toml"), "nowhere.toml"),
        (("--firmware", "nowhere.hex"), "nowhere.hex"),
        (("--firmware", "pyproject.toml"), "pyproject.toml, line 1: this is no Intel HEX record"),
        (("--eeprom", "/proc/version"), "/proc/version: cannot be written"),
        (("--speed", "7"), "'7' is not one of '1', 'max'"),
    ],
)
def test_bad_options_are_one_sentence(
    options: tuple[str, ...], sentence: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "argv", ["greywhale_sim", *options])
    with pytest.raises(SystemExit) as ended:
        sys.exit(main())
    told = capsys.readouterr()
    assert ended.value.code in (1, 2)
    assert sentence in told.err
    assert told.out == ""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_end_serving_cleanly(leader_file: Path, tmp_path: Path, number: signal.Signals) -> None:
    link = tmp_path / "bench"
    ready: list[bool] = []

    def on_ready(port: str) -> None:
        ready.append(link.exists())
        os.kill(os.getpid(), number)

    serve(ServeOptions(leader=leader_file, link=link), on_ready)
    assert ready == [True]
    assert not link.is_symlink()
