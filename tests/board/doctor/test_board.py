"""The board's words about itself and its link, and its parameters against a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from greywhale import __version__
from greywhale.board.doctor.board import examine_hello, examine_status, examine_table
from greywhale.board.doctor.finding import Verdict
from greywhale.board.doctor.link import Traffic, examine_traffic
from greywhale.files import parameter_file
from greywhale.protocol import schema
from greywhale.protocol.table import ParameterTable
from tests.files.older_parameters import write_older

MINE = str(__version__)
HELLO = schema.HelloReply(
    schema.PROTOCOL, 0, 1, 0, schema.SCHEMA_HASH, schema.Board.MEGA2560, 0x1234,
    schema.ParamSource.BANK_A, schema.ResetCause.EXTERNAL,
)  # fmt: skip
STATUS = schema.StatusReply(
    schema.State.DISABLED, schema.StopReason.NONE, schema.Fault.NONE, 255, 5000, 0, 0, 0, 0, 0, 120,
    schema.SaveState.IDLE, 12, schema.Clutch.ENGAGED,
)  # fmt: skip


def verdict(check: str, *, hello: schema.HelloReply = HELLO, status: schema.StatusReply = STATUS) -> Verdict:
    found = examine_hello(hello, MINE) + examine_status(hello, status)
    return next(one.verdict for one in found if one.check == check)


@pytest.mark.parametrize("check", ["firmware", "stored set", "last start", "fault", "ticks", "EEPROM"])
def test_a_sound_board_is_good_in_every_way(check: str) -> None:
    assert verdict(check) is Verdict.GOOD


def test_each_trouble_is_told_in_its_own_finding() -> None:
    assert verdict("stored set", hello=replace(HELLO, param_source=schema.ParamSource.DEFAULTS)) is Verdict.NOTE
    for cause in (schema.ResetCause.BROWN_OUT, schema.ResetCause.WATCHDOG):
        assert verdict("last start", hello=replace(HELLO, reset_cause=cause)) is Verdict.BAD
    assert verdict("fault", status=replace(STATUS, fault=schema.Fault.TRACKING, fault_where=2)) is Verdict.BAD
    assert verdict("ticks", status=replace(STATUS, late_ticks=1)) is Verdict.BAD


@pytest.mark.parametrize(
    ("saves", "expected", "says"),
    [
        (0, Verdict.GOOD, "No set is stored"),
        (1, Verdict.GOOD, "1 save: less than 0.1 % of the 100,000"),
        (12_345, Verdict.GOOD, "12,345 saves: 12.3 % of the 100,000"),
        (50_000, Verdict.NOTE, "50,000 saves: 50.0 % of the 100,000"),
    ],
)
def test_the_saves_are_told_against_what_a_cell_is_made_for(saves: int, expected: Verdict, says: str) -> None:
    (wear,) = (one for one in examine_status(HELLO, replace(STATUS, saves=saves)) if one.check == "EEPROM")
    assert wear.verdict is expected
    assert wear.says.startswith(says)


def test_another_version_is_worth_a_note() -> None:
    (firmware, _) = examine_hello(HELLO, "0.0.9")
    assert firmware.verdict is Verdict.NOTE
    assert "greywhale flash" in firmware.remedy


def test_the_set_of_a_file_is_good_and_every_difference_is_named(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    parameter_file.save(path, ParameterTable.defaults())
    same, _ = examine_table(ParameterTable.defaults(), path)
    assert same.verdict is Verdict.GOOD
    changed, _ = examine_table(ParameterTable.defaults().with_raw({"joint1.motor_sign": -1, "supply_mv": 12000}), path)
    assert changed.verdict is Verdict.BAD
    assert changed.says.startswith(f"Not as in {path}: ")
    assert "joint1.motor_sign is -1, not 1" in changed.says
    assert "supply_mv is 12000, not 15000" in changed.says


@pytest.mark.parametrize("layout", range(1, schema.LAYOUT))
def test_what_an_older_file_does_not_state_is_no_difference(tmp_path: Path, layout: int) -> None:
    path = tmp_path / "older.toml"
    write_older(path, ParameterTable.defaults(), layout)
    newer = next(one for one in schema.PARAMETERS if one.since > layout)
    board = ParameterTable.defaults().with_raw({newer.name: newer.maximum})
    same, _ = examine_table(board, path)
    assert same.verdict is Verdict.GOOD
    assert "It is older and says nothing of" in same.says
    changed, _ = examine_table(board.with_raw({"supply_mv": 12000}), path)
    assert newer.name not in changed.says


def test_a_calibration_is_missed_until_every_potentiometer_has_one() -> None:
    (plain,) = examine_table(ParameterTable.defaults(), None)
    assert plain.verdict is Verdict.NOTE
    assert plain.says.startswith("8 potentiometers have the shipped zero")
    some = {f"leader{number}.zero": 8000 for number in range(4)} | {f"follower{n}.scale": -10734 for n in range(3)}
    (one,) = examine_table(ParameterTable.defaults().with_raw(some), None)
    assert one.says.startswith("1 potentiometer has the shipped zero and scale (follower3)")
    (done,) = examine_table(ParameterTable.defaults().with_raw(some | {"follower3.zero": 9000}), None)
    assert done.verdict is Verdict.GOOD


def test_joints_that_are_not_in_use_are_told_and_no_trouble() -> None:
    def told(*idle: int) -> list[str]:
        table = ParameterTable.defaults().with_raw({f"follower{joint}.scale": 0 for joint in idle})
        return [f"{one.verdict.name}: {one.says}" for one in examine_table(table, None) if one.check == "joints"]

    assert told() == []
    assert told(2, 3) == ["GOOD: Joints 2 and 3 are not in use (follower's scale 0)."]
    assert told(1) == ["GOOD: Joint 1 is not in use (follower's scale 0)."]
    assert told(0, 1, 2, 3) == ["BAD: No joint is in use: every follower's scale is 0."]


CLEAN = Traffic(10_001, 0, 1250, 0, 0.004, 0, 0, 0)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("lost", "3 samples were lost"),
        ("wrong", "3 answers were wrong"),
        ("frames_bad", "3 frames reached the board damaged"),
        ("rx_overruns", "3 times the board lost bytes"),
    ],
)
def test_each_loss_is_bad_and_counted(name: str, says: str) -> None:
    found = examine_traffic(replace(CLEAN, **{name: 3}), 0.3)
    assert found.verdict is Verdict.BAD
    assert says in found.says


def test_a_slow_answer_alone_is_a_note() -> None:
    found = examine_traffic(replace(CLEAN, slowest_s=0.6), 0.3)
    assert found.verdict is Verdict.NOTE
    assert "an answer took 0.60 s" in found.says
