"""The bench in a process of its own, the host's own Device on its serial port: nothing between them but bytes."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from greywhale.board.device import Device
from greywhale.board.record import record
from greywhale.board.upload import upload_controller
from greywhale.cli import entry
from greywhale.demo import BenchProcess
from greywhale.errors import UserError
from greywhale.files.log import read_log
from greywhale.measure import evaluate
from greywhale.protocol import schema
from greywhale.protocol.schema import Fault, State, StopReason

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "shared" / "fuzzy_tables"

Start = Callable[..., BenchProcess]


@pytest.mark.slow
def test_every_open_resets_the_board(start_bench: Start) -> None:
    bench = start_bench()
    with Device(bench.port) as device:
        assert device.hello.board.key == "mega2560"
        first = device.status().tick
        assert device.status().tick > first
    resets = bench.command("status")["resets"]
    with Device(bench.port) as device:
        assert device.status().stop_reason is StopReason.RESET
    status = bench.command("status")
    assert status["resets"] == resets + 1
    assert status["resets_by_host"] == 2


def test_upload_record_evaluate(start_bench: Start, tmp_path: Path) -> None:
    bench = start_bench()
    with Device(bench.port) as device:
        uploaded = upload_controller(device, TABLES / "table_8.toml")
        assert uploaded.changed
        recording = record(device, tmp_path / "log.csv", 4.0, enable=True)
        assert device.status().state is State.DISABLED
    assert not bench.command("status")["motors_enabled"]
    assert (recording.rows, recording.dropped) == (4000, 0)
    log = read_log(tmp_path / "log.csv")
    assert log.complete
    assert log.origin.param_crc == uploaded.param_crc
    assert set(log.state) == {"following"}
    measures = evaluate(log)
    for joint in measures.joints:
        assert 1e-7 < joint.mse < 0.02, "following, but not perfectly"
    assert abs(log.voltage).max() > 1.0


@pytest.mark.slow
def test_uploaded_controllers_survive_a_restart(start_bench: Start, tmp_path: Path) -> None:
    eeprom = ("--eeprom", str(tmp_path / "eeprom.bin"))
    bench = start_bench(*eeprom)
    with Device(bench.port) as device:
        built_in = device.hello.param_crc
        crc = upload_controller(device, TABLES / "table_10.toml").param_crc
        assert crc != built_in
    bench.close()
    with Device(start_bench(*eeprom).port) as device:
        assert device.hello.param_crc == crc
        assert device.hello.param_source is not schema.ParamSource.DEFAULTS


@pytest.mark.slow
@pytest.mark.parametrize("writes", [1, 60, 150])
def test_a_power_cut_during_a_save_keeps_the_old_set(start_bench: Start, tmp_path: Path, writes: int) -> None:
    bench = start_bench("--eeprom", str(tmp_path / "eeprom.bin"))
    with Device(bench.port) as device:
        old = upload_controller(device, TABLES / "before_tuning.toml").param_crc
        bench.command(f"power off {writes}")
        with pytest.raises(UserError):
            upload_controller(device, TABLES / "table_10.toml")
    assert bench.command("status")["powered"] is False
    bench.command("power on")
    with Device(bench.port) as device:
        assert device.hello.param_crc == old
        new = upload_controller(device, TABLES / "table_10.toml").param_crc
    with Device(bench.port) as device:
        assert device.hello.param_crc == new != old


@pytest.mark.slow
def test_a_broken_potentiometer_ends_the_recording(start_bench: Start, tmp_path: Path) -> None:
    bench = start_bench()
    reported: list[str] = []

    def break_it(what: str, fraction: float) -> None:
        if what == "recording" and not reported:
            reported.append(what)
            bench.command("pot follower 2 open")

    with Device(bench.port) as device, pytest.raises(UserError, match="potentiometer 2"):
        record(device, tmp_path / "log.csv", 60.0, enable=True, progress=break_it)
    assert reported
    assert not bench.command("status")["motors_enabled"]
    assert not read_log(tmp_path / "log.csv").complete


@pytest.mark.slow
def test_info_names_broken_potentiometers_before_anyone_enables(
    start_bench: Start, capsys: pytest.CaptureFixture[str]
) -> None:
    bench = start_bench()
    bench.command("pot leader 1 shorted")
    bench.command("pot follower 3 open")
    assert entry.run(["info", "--port", bench.port]) == 0
    told = capsys.readouterr().out
    broken = re.findall(r"(leader|follower) potentiometer (\d) reads (\d+)\.\.(\d+) of 1023, at a rail", told)
    assert broken == [("leader", "1", "1023", "1023"), ("follower", "3", "0", "0")]


@pytest.mark.slow
def test_ctrl_c_stops_the_motors(start_bench: Start, tmp_path: Path) -> None:
    bench = start_bench()

    def press(what: str, fraction: float) -> None:
        if what == "recording":
            raise KeyboardInterrupt

    with Device(bench.port) as device:
        with pytest.raises(KeyboardInterrupt):
            record(device, tmp_path / "log.csv", 60.0, enable=True, progress=press)
        assert device.status().stop_reason is StopReason.HOST
        assert not bench.command("status")["motors_enabled"]


HOST_THAT_DIES = """
import sys
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
def test_a_killed_host_leaves_no_motor_on(start_bench: Start) -> None:
    bench = start_bench()
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


def test_a_second_host_is_turned_away(start_bench: Start) -> None:
    bench = start_bench()
    with Device(bench.port) as device:
        with pytest.raises(UserError, match="in use"):
            Device(bench.port)
        assert device.status().state is State.DISABLED


@pytest.mark.slow
def test_noise_on_the_line_delays_but_corrupts_nothing(start_bench: Start) -> None:
    bench = start_bench()
    with Device(bench.port) as device:
        bench.command("line flip 0.002")
        bench.command("line lose 0.002")
        crc = upload_controller(device, TABLES / "table_10.toml").param_crc
        bench.command("line flip 0")
        bench.command("line lose 0")
        status = device.status()
        assert status.frames_bad > 0, "the noise was there"
        assert (status.state, status.fault) == (State.DISABLED, Fault.NONE)
    with Device(bench.port) as device:
        assert device.hello.param_crc == crc


@pytest.mark.slow
def test_a_board_without_firmware_is_silent_and_that_is_said(start_bench: Start) -> None:
    bench = start_bench("--blank")
    with pytest.raises(UserError, match="flash"):
        Device(bench.port, quiet_s=0.5, patience_s=1.0)


@pytest.mark.slow
def test_the_bench_ends_with_its_parent_and_leaves_no_link(start_bench: Start, tmp_path: Path) -> None:
    link = tmp_path / "bench"
    bench = start_bench("--link", str(link))
    assert bench.port == str(link)
    assert link.is_symlink()
    bench.close()
    assert bench.exit_code == 0
    assert not link.is_symlink()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--leader", "nowhere.csv"), "nowhere.csv: cannot be read"),
        (("--arm", "nowhere.toml"), "nowhere.toml"),
        (("--firmware", "nowhere.hex"), "nowhere.hex"),
        (("--firmware", "pyproject.toml"), "pyproject.toml, line 1: a record must begin with a colon"),
        (("--eeprom", "/proc/version"), "/proc/version: cannot be written"),
        (("--speed", "7"), "invalid choice"),
    ],
)
def test_bad_options_are_one_sentence(options: tuple[str, ...], sentence: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "greywhale_sim", *options], capture_output=True, text=True, timeout=60, cwd=ROOT
    )
    assert done.returncode in (1, 2)
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_end_the_bench_cleanly(leader_file: Path, tmp_path: Path, number: signal.Signals) -> None:
    link = tmp_path / "bench"
    command = [sys.executable, "-m", "greywhale_sim", "--leader", str(leader_file), "--link", str(link)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as bench:
        assert bench.stdout is not None
        assert bench.stdout.readline().decode().strip() == str(link)
        assert link.exists()
        bench.send_signal(number)
        _, errors = bench.communicate(timeout=30)
    assert bench.returncode == 0
    assert errors == b""
    assert not link.is_symlink()


@pytest.mark.slow
def test_threads_can_watch_a_bench_while_it_is_used(start_bench: Start, tmp_path: Path) -> None:
    """The control line and the serial port do not wait for each other."""
    bench = start_bench()
    seen: list[dict[str, Any]] = []
    with Device(bench.port) as device:
        watcher = threading.Thread(target=lambda: seen.extend(bench.command("status") for _ in range(20)))
        watcher.start()
        record(device, tmp_path / "log.csv", 2.0)
        watcher.join()
    times = [status["time_s"] for status in seen]
    assert times == sorted(times)
    assert len(times) == 20
