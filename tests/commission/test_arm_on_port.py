"""The arm on its port: what a busy computer spoils is led again, a few times; what the arm does is not."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.limits import RECORDING
from greywhale.board.stream import LeaseLostError
from greywhale.commission.arm_on_port import TRIES, ArmOnPort
from greywhale.files.arm import load_arm
from greywhale.files.log import read_log
from greywhale.files.trajectory import Trajectory
from greywhale.protocol import schema
from greywhale.protocol.schema import Fault, State
from greywhale.protocol.table import ParameterTable
from tests.board.fake_board import FakeBoard, Faults, served

STILL = Trajectory(np.array([0.0, 2.5]), np.zeros((2, 4)))  # longer than the lease
ARM = load_arm("white_box")
BUSY = "this computer was too busy: once more, attempt"


class Told(list[str]):
    def __call__(self, what: str, fraction: float) -> None:
        self.append(what)

    @property
    def busy(self) -> int:
        return sum(what.startswith(BUSY) for what in self)


@pytest.fixture
def arm() -> Iterator[tuple[FakeBoard, ArmOnPort, Told]]:
    told = Told()
    with served() as (board, device):
        yield board, ArmOnPort(device, ParameterTable.defaults(), ARM, told), told


def late(times: int, board: FakeBoard, device: Device, patch: pytest.MonkeyPatch) -> None:
    """The computer has no time to renew the lease, the first so many times that it leads."""
    renew: Callable[[], None] = device.renew
    patch.setattr(device, "renew", lambda: None if board.asked(schema.LeadRequest) <= times else renew())


@pytest.mark.parametrize("times", range(TRIES))
def test_what_this_computer_spoilt_is_led_again(
    times: int, arm: tuple[FakeBoard, ArmOnPort, Told], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    board, rig, told = arm
    late(times, board, rig.device, monkeypatch)
    played = rig.play(STILL, tmp_path / "log.csv", rig.before)
    assert not played.stopped
    assert read_log(tmp_path / "log.csv").complete
    assert board.asked(schema.LeadRequest) == 1 + times
    assert told.busy == times
    assert board.lease_ms == RECORDING.busy_lease_ms > RECORDING.lease_ms


def test_after_a_few_tries_it_says_so(
    arm: tuple[FakeBoard, ArmOnPort, Told], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    board, rig, _ = arm
    late(TRIES, board, rig.device, monkeypatch)
    with pytest.raises(LeaseLostError, match="board went on, but this computer") as caught:
        rig.play(STILL, tmp_path / "log.csv", rig.before)
    assert f"It was tried {TRIES} times." in caught.value.__notes__
    assert board.asked(schema.LeadRequest) == TRIES
    assert board.state is State.DISABLED


@pytest.mark.parametrize("fault", [Fault.UNREST, Fault.SPEED, Fault.RUNAWAY, Fault.TRACKING])
def test_a_joint_that_the_log_does_not_show_to_turn_did_not_swing(fault: Fault, tmp_path: Path) -> None:
    with served(Faults(fault_at=(400, fault, 1))) as (_, device):
        arm = ArmOnPort(device, ParameterTable.defaults(), ARM, Told())
        played = arm.play(STILL, tmp_path / "log.csv", arm.before)
    assert played.joint == 1
    assert played.swung is (fault is Fault.UNREST), "unrest is swings by its definition"


@pytest.mark.parametrize(
    "faults",
    [
        Faults(fault_at=(400, Fault.POT_LOW, 1)),
        Faults(restart_at=400),
        Faults(unplug_at=400),
        Faults(stop_sampling_at=400),
    ],
    ids=["a broken wire", "a restart", "a lost port", "no samples"],
)
def test_what_the_board_or_its_cable_did_is_not_led_again(faults: Faults, tmp_path: Path) -> None:
    told, before = Told(), ParameterTable.defaults()
    with FakeBoard(faults) as board:
        with pytest.raises(UserError) as caught, Device(board.port, quiet_s=0.0) as device:
            ArmOnPort(device, before, ARM, told).play(STILL, tmp_path / "log.csv", before)
        assert board.asked(schema.LeadRequest) == 1
    assert not isinstance(caught.value, LeaseLostError)
    assert told.busy == 0
