"""A set on trial runs, but is not stored: after its next start the board runs what it had."""

from __future__ import annotations

import pytest

from greywhale.base.errors import UserError
from greywhale.board.device import Device
from greywhale.board.upload import read_parameters, run_set
from greywhale.protocol import schema
from tests.board.fake_board import FakeBoard


def open_device(board: FakeBoard) -> Device:
    return Device(board.port, quiet_s=0.0, patience_s=0.5)


def test_a_set_on_trial_runs_and_is_not_stored() -> None:
    with FakeBoard() as board, open_device(board) as device:
        before = read_parameters(device)
        trial = before.with_raw({"joint1.kp": 77777})
        run_set(device, trial)
        assert tuple(board.running) == trial.raw
        assert tuple(board.stored) == before.raw
        assert board.asked(schema.ParamSaveRequest) == 0
        run_set(device, before)
        assert tuple(board.running) == before.raw


def test_a_set_that_does_not_arrive_is_noticed() -> None:
    with FakeBoard() as board, open_device(board) as device:
        trial = read_parameters(device).with_raw({"joint1.kp": 77777})
        board.faults.wrong_crc_after_apply = True
        with pytest.raises(UserError, match="runs a set with CRC"):
            run_set(device, trial)
