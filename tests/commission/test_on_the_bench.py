"""A commissioning through the serial port: the firmware on the simulated board is led, stopped, and left as it was."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import Progress
from greywhale.board import record
from greywhale.board.device import Device
from greywhale.board.record import Recording
from greywhale.board.upload import read_parameters
from greywhale.cli.entry import run
from greywhale.cli.story import BenchProcess, RunningBench
from greywhale.commission import arm_on_port
from greywhale.commission import run as commissioning
from greywhale.commission.arm_on_port import connected
from greywhale.commission.motions import JointRange, check_motion, first_motion
from greywhale.files.arm import load_arm
from greywhale.files.log import read_log
from greywhale.files.trajectory import Trajectory
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.schema import State
from greywhale.protocol.table import ParameterTable
from greywhale_sim.lockstep import LockStepBench
from greywhale_sim.words import lock_step

pytestmark = pytest.mark.slow
BEFORE = ParameterTable.defaults()
ARM = load_arm("white_box")


@pytest.fixture
def bench() -> Iterator[LockStepBench]:
    with lock_step() as started:
        yield started


def told(what: str, fraction: float) -> None:
    """Nobody looks."""


def wild() -> ParameterTable:
    """Joint 2 a hundred times as stiff as before: it hunts on its gear's backlash."""
    rows = controllers_of(BEFORE).copy()
    rows[2, 8] *= 100
    return BEFORE.with_controllers(rows)


def small_check(pose: np.ndarray) -> JointRange:
    return JointRange(pose, pose - 0.5, pose + 0.5)


def running(bench: RunningBench) -> tuple[ParameterTable, State]:
    """What the board runs after a restart, which opening its port is; nothing of it is lost by that."""
    with Device(bench.port) as device:
        return read_parameters(device), device.status().state


def test_a_joint_that_hunts_is_stopped_at_once_and_the_controllers_from_before_run(
    bench: LockStepBench, tmp_path: Path
) -> None:
    with connected(bench.port, BEFORE, ARM, told) as arm:
        check = check_motion(small_check(arm.pose()))
        played = arm.play(check.motion, tmp_path / "log.csv", wild())
        assert played.joint == 2
        assert "joint 2 hunted" in played.stopped
        assert not bench.command("status")["motors_enabled"]
        assert read_parameters(arm.device) == BEFORE
        assert arm.device.status().state is State.DISABLED
        log = read_log(tmp_path / "log.csv")
        assert not log.complete
        assert log.time[-1] < 5.0
        assert log.origin.param_crc == wild().crc
        calm = arm.play(first_motion(small_check(arm.pose()), 0.1), tmp_path / "calm.csv", BEFORE)
        assert not calm.stopped, "the rig goes on after a joint has hunted"


def test_a_fault_of_the_board_ends_the_trial_and_not_the_commissioning(bench: LockStepBench, tmp_path: Path) -> None:
    """Nearly no voltage: the follower stays behind its leader until the board stops it."""
    rows = controllers_of(BEFORE).copy()
    rows[:, 11] = 50
    with connected(bench.port, BEFORE, ARM, told) as arm:
        pose = arm.pose()
        room = JointRange(pose, pose - 1.2, pose + 1.2)
        played = arm.play(check_motion(room).motion, tmp_path / "log.csv", BEFORE.with_controllers(rows), watched=False)
        assert "the board stopped" in played.stopped
        assert arm.device.status().state is State.DISABLED
        assert read_parameters(arm.device) == BEFORE


def test_another_board_than_the_one_it_began_with_is_refused(bench: LockStepBench) -> None:
    with pytest.raises(UserError, match="but this commissioning began with"):
        with connected(bench.port, wild(), ARM, told):
            pass


def test_a_line_lost_in_the_middle_leaves_motors_off_and_the_controllers_from_before(
    bench: LockStepBench, tmp_path: Path
) -> None:
    def cut(what: str, fraction: float) -> None:
        if what == "recording" and fraction > 0.02:
            bench.command("line lose 1")

    trial = BEFORE.with_raw({"joint0.kp": 50000})
    with pytest.raises(UserError), connected(bench.port, BEFORE, ARM, cut) as arm:
        arm.play(check_motion(small_check(arm.pose())).motion, tmp_path / "log.csv", trial)
    assert read_log(tmp_path / "log.csv").origin.param_crc == trial.crc, "it ran when the line was lost"
    assert not bench.command("status")["motors_enabled"]
    bench.command("line lose 0")
    assert running(bench) == (BEFORE, State.DISABLED)


def send_at(motion_file: str, number: int, patch: pytest.MonkeyPatch) -> None:
    """This program gets the signal while it leads the arm along that motion; the excitation is the first that comes."""

    def record_led(device: Device, path: Path, motion: Trajectory, *, progress: Progress, **options: Any) -> Recording:
        def told(what: str, fraction: float) -> None:
            progress(what, fraction)
            if path.name == motion_file and what == "recording" and fraction > 0.02:
                signal.raise_signal(number)

        return record.record_led(device, path, motion, progress=told, **options)

    patch.setattr(arm_on_port, "record_led", record_led)
    patch.setattr(commissioning, "GOOD_BUDGET", 1)


def commission_killed(port: str, folder: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        send_at("first-1.csv", signal.SIGKILL, patch)
        run(["-q", "commission", "-p", port, "-o", str(folder)])


def test_a_killed_program_leaves_motors_off_and_the_controllers_from_before(tmp_path: Path) -> None:
    """Not even Ctrl-C: the lease ends, and the next start brings the stored set back."""
    with BenchProcess("--speed", "max") as bench:
        program = get_context("fork").Process(target=commission_killed, args=(bench.port, tmp_path))
        program.start()
        program.join()
        assert program.exitcode == -signal.SIGKILL
        assert running(bench) == (BEFORE, State.DISABLED)


def test_ctrl_c_stops_the_motors_and_says_how_to_go_on(
    bench: LockStepBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    send_at("before.csv", signal.SIGINT, monkeypatch)
    assert run(["-q", "commission", "-p", bench.port, "-o", str(tmp_path)]) == 130
    assert "--resume goes on" in capsys.readouterr().err
    assert not bench.command("status")["motors_enabled"]
    assert running(bench) == (BEFORE, State.DISABLED)
    steps = [json.loads(line).get("step") for line in (tmp_path / "commission.journal").read_text().splitlines()]
    assert "first motion" in steps
    assert "before" not in steps
