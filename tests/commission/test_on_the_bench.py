"""A commissioning through the serial port: the firmware on the simulated board is led, stopped, and left as it was."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from greywhale.board.device import Device
from greywhale.board.upload import read_parameters
from greywhale.cli.entry import run
from greywhale.commission.motions import Room, check_motion, first_motion
from greywhale.commission.rig import connected
from greywhale.demo import BenchProcess
from greywhale.errors import UserError
from greywhale.files.arm import default_arm
from greywhale.files.log import read_log
from greywhale.files.model import to_toml
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.schema import State
from greywhale.table import ParameterTable
from tests.commission.test_start import with_joint, with_pot

pytestmark = pytest.mark.slow
BEFORE = ParameterTable.defaults()


@pytest.fixture
def bench() -> Iterator[BenchProcess]:
    with BenchProcess("--speed", "max") as started:
        yield started


def told(what: str, fraction: float) -> None:
    """Nobody looks."""


def wild() -> ParameterTable:
    """Joint 2 a hundred times as stiff as before: it hunts on its gear's backlash."""
    rows = controllers_of(BEFORE).copy()
    rows[2, 8] *= 100
    return BEFORE.with_controllers(rows)


def small_check(rig_pose: np.ndarray) -> Room:
    return Room(rig_pose, rig_pose - 0.5, rig_pose + 0.5)


def running(bench: BenchProcess) -> tuple[ParameterTable, State]:
    """What the board runs after a restart, which opening its port is; nothing of it is lost by that."""
    with Device(bench.port) as device:
        return read_parameters(device), device.status().state


def test_a_joint_that_hunts_is_stopped_at_once_and_the_controllers_from_before_run(
    bench: BenchProcess, tmp_path: Path
) -> None:
    with connected(bench.port, BEFORE, told) as rig:
        check = check_motion(small_check(rig.pose()))
        played = rig.play(check.motion, tmp_path / "log.csv", wild())
        assert played.joint == 2
        assert "joint 2 hunted" in played.stopped
        assert not bench.command("status")["motors_enabled"]
        assert read_parameters(rig.device) == BEFORE
        assert rig.device.status().state is State.DISABLED
        log = read_log(tmp_path / "log.csv")
        assert not log.complete
        assert log.time[-1] < 5.0
        assert log.origin.param_crc == wild().crc
        calm = rig.play(first_motion(small_check(rig.pose()), 0.1), tmp_path / "calm.csv", BEFORE)
        assert not calm.stopped, "the rig goes on after a joint has hunted"


def test_a_fault_of_the_board_ends_the_trial_and_not_the_commissioning(bench: BenchProcess, tmp_path: Path) -> None:
    """Nearly no voltage: the follower stays behind its leader until the board stops it."""
    rows = controllers_of(BEFORE).copy()
    rows[:, 11] = 50
    with connected(bench.port, BEFORE, told) as rig:
        pose = rig.pose()
        room = Room(pose, pose - 1.2, pose + 1.2)
        played = rig.play(check_motion(room).motion, tmp_path / "log.csv", BEFORE.with_controllers(rows), watched=False)
        assert "the board stopped" in played.stopped
        assert rig.device.status().state is State.DISABLED
        assert read_parameters(rig.device) == BEFORE


def test_another_board_than_the_one_it_began_with_is_refused(bench: BenchProcess) -> None:
    with pytest.raises(UserError, match="but this commissioning began with"):
        with connected(bench.port, wild(), told):
            pass


def test_a_line_lost_in_the_middle_leaves_motors_off_and_the_controllers_from_before(
    bench: BenchProcess, tmp_path: Path
) -> None:
    def cut(what: str, fraction: float) -> None:
        if what == "recording" and fraction > 0.2:
            bench.command("line lose 1")

    trial = BEFORE.with_raw({"joint0.kp": 50000})
    with pytest.raises(UserError), connected(bench.port, BEFORE, cut) as rig:
        rig.play(check_motion(small_check(rig.pose())).motion, tmp_path / "log.csv", trial)
    assert read_log(tmp_path / "log.csv").origin.param_crc == trial.crc, "it ran when the line was lost"
    assert not bench.command("status")["motors_enabled"]
    bench.command("line lose 0")
    assert running(bench) == (BEFORE, State.DISABLED)


def test_a_killed_program_leaves_motors_off_and_the_controllers_from_before(
    bench: BenchProcess, tmp_path: Path
) -> None:
    """Not even Ctrl-C: the lease ends, and the next start brings the stored set back."""
    _end_during_the_check(bench, tmp_path, signal.SIGKILL)
    assert running(bench) == (BEFORE, State.DISABLED)


def test_ctrl_c_stops_the_motors_and_says_how_to_go_on(bench: BenchProcess, tmp_path: Path) -> None:
    code, errors = _end_during_the_check(bench, tmp_path, signal.SIGINT)
    assert code == 130
    assert "--resume goes on" in errors
    assert "Traceback" not in errors
    assert not bench.command("status")["motors_enabled"]
    assert running(bench) == (BEFORE, State.DISABLED)
    steps = json.loads((tmp_path / "out" / "commission.json").read_text())["steps"]
    assert "first motion" in steps
    assert "before" not in steps


def _end_during_the_check(bench: BenchProcess, folder: Path, number: int) -> tuple[int, str]:
    """Send a commissioning the signal while it leads the arm along the check."""
    command = [sys.executable, "-m", "greywhale", "commission", "-p", bench.port, "-o", str(folder / "out")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        while not list((folder / "out").glob("before.unfinished*.csv")):
            assert process.poll() is None, process.communicate()[1]
        while not bench.command("status")["motors_enabled"]:
            assert process.poll() is None, process.communicate()[1]
        process.send_signal(number)
        errors = process.communicate(timeout=60)[1]
    return process.returncode, errors


def test_a_blocked_arm_and_an_uncalibrated_one_are_refused_in_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    blocked = with_joint(default_arm(), 1, "friction", coulomb=50.0, breakaway=50.0)
    arms = {"blocked": blocked, "other": with_pot(default_arm(), 3, centre=0.5)}
    for name, arm in arms.items():
        (tmp_path / f"{name}.toml").write_text(to_toml(arm, {}).replace("[identification]\n", ""), encoding="utf-8")
    with BenchProcess("--speed", "max", "--arm", str(tmp_path / "blocked.toml")) as bench:
        assert run(["-q", "commission", "-p", bench.port, "-o", str(tmp_path / "one")]) == 1
        first = capsys.readouterr().err
        arguments = ["-p", bench.port, "-o", str(tmp_path / "two"), "--arm", str(tmp_path / "other.toml")]
        assert run(["-q", "commission", *arguments]) == 1
        second = capsys.readouterr().err
        assert running(bench) == (BEFORE, State.DISABLED)
    assert "its follower did not move (joint 1)" in first, "the board told it"
    assert "joint 3 (wrist roll) was never calibrated" in second
    assert first.count("\n") == second.count("\n") == 1
