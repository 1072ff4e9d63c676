"""Earlier calibrations: none is lost or written over, and what differs is said in words."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path

import pytest
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from greywhale.base import state
from greywhale.base.errors import UserError
from greywhale.board.calibrate import history
from greywhale.board.calibrate.differences import differences
from greywhale.files import parameter_file
from greywhale.protocol.ports import lasting_label
from greywhale.protocol.table import ParameterTable

NOW = datetime(2026, 5, 31, 9, 30, 7, tzinfo=UTC)
USUAL = ParameterTable.defaults()


def with_limit(raw: int) -> ParameterTable:
    return USUAL.with_raw({"joint1.limit_max": raw, "joint1.kp": 7 * raw})


def test_a_calibration_is_kept_once_and_its_file_is_a_backup(tmp_path: Path) -> None:
    first = history.keep(tmp_path, with_limit(9000), "found", NOW)
    assert first == history.Kept(1, NOW, "found", tmp_path / "0001-20260531T093007Z-found.toml")
    assert history.keep(tmp_path, with_limit(9000).with_raw({"joint0.kp": 1}), "set", NOW) is None
    second = history.keep(tmp_path, with_limit(9001), "set", NOW)
    assert history.kept(tmp_path) == [first, second]
    assert parameter_file.load(first.path).raw == with_limit(9000).raw
    assert history.find(tmp_path, 2) == second
    with pytest.raises(UserError, match="no calibration 3 of this board; there are 1 to 2"):
        history.find(tmp_path, 3)


def test_many_at_once_lose_none(tmp_path: Path) -> None:
    """The lock is on the opened file, so threads stand for programs."""
    tables = [with_limit(9000 + number) for number in range(24)]
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda table: history.keep(tmp_path, table, "set", NOW), tables))
    found = history.kept(tmp_path)
    assert [one.number for one in found] == list(range(1, 25))
    assert sorted(one.values()["joint1.limit_max"] for one in found) == list(range(9000, 9024))
    assert {path.name for path in tmp_path.iterdir()} == {".lock", *(one.path.name for one in found)}


def test_a_damaged_file_stays_and_the_next_one_comes_after_it(tmp_path: Path) -> None:
    history.keep(tmp_path, with_limit(9000), "found", NOW)
    damaged = history.kept(tmp_path)[0].path
    damaged.write_text("no parameters", encoding="utf-8")
    (tmp_path / "notes.toml").write_text("", encoding="utf-8")
    assert history.keep(tmp_path, with_limit(9000), "set", NOW) is not None
    assert [one.number for one in history.kept(tmp_path)] == [1, 2]
    assert damaged.read_text(encoding="utf-8") == "no parameters"


def test_before_and_after_are_kept_around_a_change_even_if_it_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(state.VARIABLE, str(tmp_path))
    folder = history.folder_of("/dev/none")
    assert folder == tmp_path / "calibrations" / "dev-none"
    with history.keeping("/dev/none", USUAL, USUAL.with_raw({"joint0.kp": 1}), "set"):
        pass
    assert not folder.exists(), "the calibration stays"
    with pytest.raises(UserError), history.keeping("/dev/none", USUAL, with_limit(9000), "set"):
        raise UserError("The board went away.")
    assert [one.why for one in history.kept(folder)] == ["found"]
    with history.keeping("/dev/none", USUAL, with_limit(9000), "set"):
        assert len(history.kept(folder)) == 1, "not before the board has it"
    assert [one.why for one in history.kept(folder)] == ["found", "set"]


def test_a_board_is_known_by_its_serial_number_or_its_socket(monkeypatch: pytest.MonkeyPatch) -> None:
    mega, clone = ListPortInfo("/dev/ttyACM7"), ListPortInfo("/dev/ttyUSB7")
    mega.vid, mega.pid, mega.serial_number = 0x2341, 0x42, "../7563/A B"
    clone.vid, clone.pid = 0x1A86, 0x7523
    monkeypatch.setattr(list_ports, "comports", lambda: [mega, clone])
    assert lasting_label("/dev/ttyACM7") == "usb-2341-0042-7563-A-B"
    assert lasting_label("/dev/ttyUSB7") == "dev-ttyUSB7"
    assert lasting_label("socket://box:4000") == "socket-box-4000"


def test_differences_are_said_in_words_and_degrees_joint_by_joint() -> None:
    before = history.calibration_of(USUAL)
    assert differences(before, before) == []
    scale = before["leader2.scale"]
    after = before | {
        "leader0.zero": before["leader0.zero"] + 546,  # of 16368 counts for 300 degrees
        "joint1.limit_max": 4096,
        "joint1.motor_sign": -1,
        "leader2.scale": -scale,
        "follower2.scale": scale // 2,
        "follower3.scale": 0,
    }
    assert differences(before, after) == [
        "joint 0 (base yaw): the leader's zero by +10.0 degrees",
        "joint 1 (shoulder pitch): limits -143.2..143.2 to -143.2..57.3 degrees, the motor the other way round",
        "joint 2 (wrist pitch): the leader reads the other way, the follower's track 300.0 to 150.0 degrees",
        "joint 3 (wrist roll): the follower is no longer in use",
    ]
