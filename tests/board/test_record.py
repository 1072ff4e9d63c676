"""Recording: what the board sent is what the log holds, losses are counted, and every bad end leaves a whole file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.board.limits import RECORDING
from greywhale.board.record import record, record_led
from greywhale.board.stream import LeaseLostError, stream
from greywhale.files.log import read_log
from greywhale.files.trajectory import Trajectory
from greywhale.protocol import schema
from greywhale.protocol.schema import Fault, State
from tests.board.fake_board import FakeBoard, Faults, open_device, served
from tests.support.interrupts import ctrl_c_at


def parts(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if path.name.startswith(".")]


def test_listening_records_every_sample_and_leaves_the_motors_alone(out: Path) -> None:
    with FakeBoard() as board:
        with open_device(board) as device:
            recording = record(device, out, seconds=0.5)
        assert board.asked(schema.EnableRequest) == 0
    log = read_log(out)
    assert (recording.rows, recording.dropped, recording.duration_s) == (500, 0, 0.5)
    assert np.array_equal(log.time, np.arange(500) / 1000)
    first = round(log.leader[0, 0] * 4096)
    assert np.array_equal(np.round(log.leader[:, 0] * 4096), first + np.arange(500))
    assert np.allclose(log.follower[0], np.array([1, 2, 3, 4]) / 4096, atol=1e-6)
    assert list(log.voltage[0]) == [15.0, -15.0, 0.0, 0.001]
    assert set(log.state) == {"disabled"}
    assert log.complete
    assert log.origin.firmware == "0.1.0"
    assert log.origin.board == "mega2560"
    assert log.origin.param_crc == schema.param_crc(schema.DEFAULTS)
    assert (log.origin.period_ms, log.origin.every_ticks) == (1, 1)


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (Faults(read_error=1), "asked for parameter 0, the board answered 1"),
        (Faults(read_garbled=schema.PARAMETER_BY_NAME["joint1.limit_max"].index), "have CRC"),
    ],
)
def test_a_motion_is_never_planned_from_limits_that_were_read_wrong(tmp_path: Path, faults: Faults, words: str) -> None:
    """The joints' limits come from a table that its CRC proves; else the motors stay off. Nor is there a log."""
    motion = Trajectory(np.array([0.0, 1.0]), np.zeros((2, 4)))
    with FakeBoard(faults) as board:
        with open_device(board) as device:
            with pytest.raises(UserError, match=words):
                record_led(device, tmp_path / "log.csv", motion)
            if faults.read_error:
                with pytest.raises(UserError, match=words):
                    record(device, tmp_path / "log.csv", 0.1)
        assert board.asked(schema.LeadRequest) == 0
    assert not list(tmp_path.iterdir())


def test_a_motion_that_is_too_fast_never_starts_a_motor(tmp_path: Path) -> None:
    quick = Trajectory(np.array([0.0, 0.1, 1.0]), np.array([[0.0] * 4, [0, 0, 1.0, 0], [0, 0, 1.0, 0]]))
    with served() as (board, device), pytest.raises(UserError, match="joint 2 at"):
        record_led(device, tmp_path / "log.csv", quick)
    assert board.asked(schema.LeadRequest) == 0
    assert not list(tmp_path.iterdir())


def test_all_samples_that_waited_while_this_host_stood_still_renew_the_lease_once() -> None:
    with served() as (board, device), device.enabled(RECORDING.lease_ms):
        received = stream(device, 1)
        for _ in range(200):
            next(received)
        board.wait(0.4)
        renewals = board.asked(schema.RenewRequest)
        for _ in range(400):
            next(received)
        assert board.asked(schema.RenewRequest) == renewals + 1


def test_following_is_recorded_from_the_end_of_the_soft_start(out: Path) -> None:
    seconds = 5 * RECORDING.lease_ms / 1000  # the lease must be renewed meanwhile
    with FakeBoard() as board:
        with open_device(board) as device:
            record(device, out, seconds, enable=True)
            assert board.state is State.DISABLED
        renewals = board.asked(schema.RenewRequest)
    log = read_log(out)
    assert set(log.state) == {"following"}
    assert len(log.time) == 5 * RECORDING.lease_ms
    assert 4 * 5 - 2 <= renewals <= 4 * 5 + 2


def test_a_disengaged_leader_is_let_go_before_the_motors_go_on(tmp_path: Path) -> None:
    with FakeBoard() as board, open_device(board) as device:
        record(device, tmp_path / "log.csv", 0.1, enable=True, disengaged=True)
        kinds = [kind for kind, _ in board.requests]
        assert kinds.index(schema.ClutchRequest.TYPE) < kinds.index(schema.EnableRequest.TYPE)
        assert board.clutch is schema.Clutch.DISENGAGED


def test_every_thins_the_samples(tmp_path: Path) -> None:
    with FakeBoard() as board, open_device(board) as device:
        record(device, tmp_path / "log.csv", 1.0, every=20)
    log = read_log(tmp_path / "log.csv")
    assert len(log.time) == 50
    assert np.allclose(np.diff(log.time), 0.02)


def test_lost_samples_are_counted_and_not_invented_and_one_that_comes_twice_is_taken_once(out: Path) -> None:
    lost, twice = frozenset({150, 151, 152, 300}), frozenset({20, 21, 50})
    with served(Faults(lose_ticks=lost, repeat_ticks=twice)) as (_, device):
        recording = record(device, out, 0.5)
    log = read_log(out)
    assert recording.dropped == log.dropped == 4
    assert len(log.time) == recording.rows == 500 - 4
    steps = np.round(np.diff(log.time) * 1000)
    assert sorted(steps[steps != 1]) == [2, 4]


@pytest.mark.parametrize(
    ("ticks", "enable", "words"),
    [
        ((1 << 31) - 1, False, r"jumped by 2147483\.648 s"),
        ((1 << 31) - 1, True, r"jumped by 2147483\.648 s"),
        (5_000, False, r"after \d\.\d+ of 3 s no sample came for 5\.001 s"),
    ],
)
def test_a_recording_whose_end_never_came_is_not_what_was_asked_for(
    out: Path, ticks: int, enable: bool, words: str
) -> None:
    with FakeBoard(Faults(jump_at=(400, ticks))) as board:
        with pytest.raises(UserError, match=words) as caught, open_device(board) as device:
            record(device, out, 3.0, enable=enable)
        assert board.state is State.DISABLED
    assert caught.value.exit_code == 1
    assert caught.value.__notes__ == [f"What was recorded is in {out}, marked as interrupted."]
    log = read_log(out)
    assert 300 < len(log.time) < 400
    assert (log.complete, log.dropped < 3000) == (False, True)


def test_a_few_samples_that_are_lost_at_the_end_are_counted(out: Path) -> None:
    with FakeBoard(Faults(lose_ticks=frozenset(range(500, 510)))) as board, open_device(board) as device:
        recording = record(device, out, 0.504, every=1)
    assert 500 < recording.rows + recording.dropped <= 504
    assert (recording.duration_s, read_log(out).complete) == (0.504, True)


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (Faults(restart_at=200), "restarted"),
        (Faults(restart_at=200, restart_says_hello=False), "restarted"),
        (Faults(unplug_at=200), "went away"),
        (Faults(fault_at=(200, Fault.POT_HIGH, 6)), r"another's \(follower potentiometer 2\)"),
        (Faults(fault_at=(200, Fault.LEADER_JUMP, 3)), r"jumped \(leader potentiometer 3\)"),
        (Faults(fault_at=(200, Fault.TRACKING, 1)), r"\(joint 1\)"),
    ],
)
def test_a_bad_end_keeps_what_was_recorded_and_says_why(out: Path, tmp_path: Path, faults: Faults, words: str) -> None:
    with FakeBoard(faults) as board:
        with pytest.raises(UserError, match=words) as caught, open_device(board) as device:
            record(device, out, 10.0, enable=True)
        assert board.state in (State.DISABLED, State.FAULT) or faults.unplug_at
    assert f"What was recorded is in {out}, marked as interrupted." in caught.value.__notes__
    log = read_log(out)
    assert not log.complete
    assert log.ended_by.startswith(caught.value.message[:60])
    assert 0 < len(log.time) < 200
    assert parts(tmp_path) == []


def test_samples_that_stop_coming_are_named(tmp_path: Path) -> None:
    with served(Faults(stop_sampling_at=100)) as (_, device), pytest.raises(UserError, match=r"\(state disabled\)"):
        record(device, tmp_path / "log.csv", 10.0)


def test_ctrl_c_stops_the_motors_and_the_log_says_so(out: Path) -> None:
    with FakeBoard() as board:
        with pytest.raises(KeyboardInterrupt), open_device(board) as device:
            record(device, out, 10.0, enable=True, progress=ctrl_c_at("recording", 0.02))
        assert board.state is State.DISABLED
    assert (read_log(out).complete, read_log(out).ended_by) == (False, "Ctrl-C, or a signal to end.")


def test_the_lease_running_out_is_named(tmp_path: Path) -> None:
    with served() as (_, device), pytest.raises(LeaseLostError, match="board went on, .* lease of 500 ms"):
        device.renew = lambda: None  # type: ignore[method-assign]
        record(device, tmp_path / "log.csv", 10.0, enable=True)
    assert len(read_log(tmp_path / "log.csv").time) <= RECORDING.lease_ms


def test_a_refused_enable_leaves_no_file(tmp_path: Path) -> None:
    faults = Faults(refuse={schema.EnableRequest.TYPE: (schema.NackCode.ERROR_TOO_LARGE, 2 << 8 | 40)})
    with served(faults) as (_, device), pytest.raises(UserError, match=r"joint 2, 1\.25 rad"):
        record(device, tmp_path / "log.csv", 1.0, enable=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("seconds", "every", "enable", "words"),
    [
        (0.0, 1, False, "duration is 0 s"),
        (float("nan"), 1, False, "duration is nan s"),
        (1e9, 1, False, r"0.01 to 86400 s"),
        (1.0, 0, False, "every 0 ticks"),
        (1.0, 101, True, "1 to 100 while the motors are on"),
    ],
)
def test_bad_settings_are_bad_usage(tmp_path: Path, seconds: float, every: int, enable: bool, words: str) -> None:
    with FakeBoard() as board, open_device(board) as device, pytest.raises(UserError, match=words) as caught:
        record(device, tmp_path / "log.csv", seconds, every, enable)
    assert caught.value.exit_code == 2
