"""Earlier calibrations from the command line: every verb that changes one keeps it, and one can go back."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from greywhale.base import state
from greywhale.cli import entry
from greywhale.protocol import schema
from tests.board.fake_board import FakeBoard

Captured = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(state.VARIABLE, str(tmp_path / "state"))
    return tmp_path / "state" / "calibrations" / "bench"


def ask(captured: Captured, board: FakeBoard, *arguments: str, code: int = 0) -> dict[str, Any]:
    assert entry.run([*arguments, "--json", "--port", board.port]) == code
    answer: dict[str, Any] = json.loads(captured.readouterr().out)
    return answer


def raw(board: FakeBoard, name: str) -> int:
    return board.stored[schema.PARAMETER_BY_NAME[name].index]


def test_what_params_changed_is_listed_and_taken_back_and_the_controllers_stay(
    tmp_path: Path, folder: Path, capsys: Captured
) -> None:
    with FakeBoard() as board:
        ask(capsys, board, "params", "backup", str(tmp_path / "backup.toml"))
        ask(capsys, board, "params", "set", "joint2.limit_max=1.0", "joint0.motor_sign=-1")
        ask(capsys, board, "params", "set", "joint2.kp=0.5")
        ask(capsys, board, "params", "restore", str(tmp_path / "backup.toml"))
        ask(capsys, board, "params", "set", "joint2.kp=0.25")
        listed = ask(capsys, board, "calibrations")
        assert listed == ask(capsys, board, "calibrate", "--history")
        assert listed["folder"] == str(folder)
        assert [one["why"] for one in listed["calibrations"]] == ["found", "set", "restore"]
        assert listed["calibrations"][1]["changed"] == [
            "joint 0 (base yaw): the motor the other way round",
            "joint 2 (wrist pitch): limits -143.2..143.2 to -143.2..57.3 degrees",
        ]
        assert entry.run(["calibrations", "--back", "2", "--port", board.port]) == 0
        told = capsys.readouterr().out
        assert raw(board, "joint2.limit_max") == 4096
        assert raw(board, "joint0.motor_sign") == -1
        assert raw(board, "joint2.kp") == 1 << 14
        assert board.running == board.stored
    assert "\n4: 20" in told
    assert ", after going back:\n" in told
    assert "The board runs and keeps calibration 2 again, as 4." in told
    assert len(list(folder.glob("*.toml"))) == 4


def test_what_another_program_gave_the_board_is_kept_before_one_goes_back(capsys: Captured) -> None:
    with FakeBoard() as board:
        ask(capsys, board, "calibrations")
        index = schema.PARAMETER_BY_NAME["leader1.zero"].index
        board.running[index] = board.stored[index] = board.staged[index] = 8000
        answer = ask(capsys, board, "calibrations", "--back", "1")
        assert answer["back_to"] == 1
        assert [one["why"] for one in answer["calibrations"]] == ["found", "found", "back"]
        assert raw(board, "leader1.zero") == schema.DEFAULTS[index]
        assert "no calibration 9" in ask(capsys, board, "calibrations", "--back", "9", code=2)["error"]


def test_a_history_that_cannot_be_written_is_a_warning(
    folder: Path, capsys: Captured, caplog: pytest.LogCaptureFixture
) -> None:
    folder.parent.parent.write_text("", encoding="utf-8")
    with FakeBoard() as board:
        ask(capsys, board, "params", "set", "joint2.limit_max=1.0")
        assert raw(board, "joint2.limit_max") == 4096
        (warning,) = caplog.messages
        assert str(folder) in warning
        assert "not in the history; GREYWHALE_STATE_DIR names another folder" in warning
        ask(capsys, board, "params", "set", "joint2.kp=0.5")
    assert caplog.messages == [warning]
