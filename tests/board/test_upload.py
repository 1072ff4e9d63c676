"""Uploads change all or nothing, are stored, and are proven by the board's own CRC."""

from __future__ import annotations

import pytest

from greywhale.base.errors import UserError
from greywhale.board import upload
from greywhale.protocol import schema
from greywhale.protocol.schema import NackCode, Refusal, SaveState
from greywhale.protocol.table import ParameterTable
from tests.board.fake_board import FakeBoard, Faults, open_device, served
from tools import ROOT

TABLE_10 = ROOT / "shared" / "fuzzy_tables" / "table_10.toml"


def index(name: str) -> int:
    return schema.PARAMETER_BY_NAME[name].index


def test_a_controller_replaces_its_own_parameters_and_no_others() -> None:
    with FakeBoard() as board:
        board.running[index("leader1.zero")] = 8000
        board.running[index("joint0.motor_sign")] = -1
        before = list(board.running)
        with open_device(board) as device:
            done = upload.upload_controller(device, TABLE_10)
        assert board.running == board.stored
        assert done.param_crc == schema.param_crc(board.running)
        changed = {p.name for p in schema.PARAMETERS if before[p.index] != board.running[p.index]}
    assert set(done.changed) == changed
    assert changed
    assert all(name.startswith("joint") for name in changed)
    raw = dict(zip([p.name for p in schema.PARAMETERS], board.running, strict=True))
    assert (raw["leader1.zero"], raw["joint0.motor_sign"]) == (8000, -1)
    assert raw["joint0.ne_c"] == round(-0.0785 * 16384)
    assert raw["joint0.kp"] == round(0.513 * 65536)
    assert raw["joint0.ku_mv"] == 15000


def test_a_wrong_echo_changes_nothing() -> None:
    with FakeBoard(Faults(echo_error=1)) as board, open_device(board) as device:
        with pytest.raises(UserError, match="period_ms = 1, .* parameter 0 = 2"):
            upload.upload_controller(device, TABLE_10)
        assert board.running == list(schema.DEFAULTS)
        assert board.asked(schema.ParamApplyRequest) == 0


def test_a_refused_set_changes_nothing_and_names_the_joint() -> None:
    refusal = (NackCode.SET_REFUSED, 1 << 8 | Refusal.GAIN)
    with FakeBoard(Faults(refuse={schema.ParamApplyRequest.TYPE: refusal})) as board, open_device(board) as device:
        with pytest.raises(UserError, match=r"\(joint 1, a gain"):
            upload.upload_controller(device, TABLE_10)
        assert board.running == board.stored == list(schema.DEFAULTS)
        assert board.asked(schema.ParamSaveRequest) == 0


def test_a_board_still_saving_is_waited_for() -> None:
    busy = (NackCode.BUSY_SAVING, 0)
    faults = Faults(refuse={schema.ParamApplyRequest.TYPE: busy})
    faults.refuse_times[schema.ParamApplyRequest.TYPE] = 3
    with FakeBoard(faults) as board, open_device(board) as device:
        upload.upload_controller(device, TABLE_10)
        assert board.asked(schema.ParamApplyRequest) == 4
        assert board.stored == board.running


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (Faults(save_result=SaveState.FAILED), "could not be stored"),
        (Faults(save_result=SaveState.SAVING), r"has not ended after 0\.2 s"),
        (Faults(wrong_crc_after_apply=True), "runs a set with CRC"),
    ],
    ids=["failed", "for ever", "another set"],
)
def test_a_set_that_is_not_running_and_stored_is_told(faults: Faults, words: str) -> None:
    with served(faults) as (_, device), pytest.raises(UserError, match=words):
        upload.upload_set(device, ParameterTable.defaults().with_raw({"joint1.kp": 77777}), save_wait_s=0.2)


def test_a_set_on_trial_runs_and_is_not_stored() -> None:
    """After its next start the board runs what it had."""
    with served() as (board, device):
        before = upload.read_parameters(device)
        trial = before.with_raw({"joint1.kp": 77777})
        upload.run_set(device, trial)
        assert tuple(board.running) == trial.raw
        assert tuple(board.stored) == before.raw
        assert board.asked(schema.ParamSaveRequest) == 0
        upload.run_set(device, before)
        assert tuple(board.running) == before.raw
        board.faults.wrong_crc_after_apply = True
        with pytest.raises(UserError, match="runs a set with CRC"):
            upload.run_set(device, trial)
