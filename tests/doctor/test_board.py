"""What a board says about itself, and its parameters against a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from greywhale import __version__
from greywhale.doctor.board import examine_hello, examine_status, examine_table
from greywhale.doctor.finding import Verdict
from greywhale.files import parameter_file
from greywhale.protocol import schema
from greywhale.table import ParameterTable

MINE = str(__version__)
HELLO = schema.HelloReply(
    schema.PROTOCOL, 0, 1, 0, schema.SCHEMA_HASH, schema.Board.MEGA2560, 0x1234,
    schema.ParamSource.BANK_A, schema.ResetCause.EXTERNAL,
)  # fmt: skip
STATUS = schema.StatusReply(
    schema.State.DISABLED, schema.StopReason.NONE, schema.Fault.NONE, 255, 5000, 0, 0, 0, 0, 0, 120,
    schema.SaveState.IDLE,
)  # fmt: skip


def verdict(check: str, *, hello: schema.HelloReply = HELLO, status: schema.StatusReply = STATUS) -> Verdict:
    found = examine_hello(hello, MINE) + examine_status(hello, status)
    return next(one.verdict for one in found if one.check == check)


@pytest.mark.parametrize("check", ["firmware", "stored set", "last start", "fault", "ticks"])
def test_a_sound_board_is_good_in_every_way(check: str) -> None:
    assert verdict(check) is Verdict.GOOD


def test_each_trouble_is_told_in_its_own_finding() -> None:
    assert verdict("stored set", hello=replace(HELLO, param_source=schema.ParamSource.DEFAULTS)) is Verdict.NOTE
    for cause in (schema.ResetCause.BROWN_OUT, schema.ResetCause.WATCHDOG):
        assert verdict("last start", hello=replace(HELLO, reset_cause=cause)) is Verdict.BAD
    assert verdict("fault", status=replace(STATUS, fault=schema.Fault.TRACKING, fault_where=2)) is Verdict.BAD
    assert verdict("ticks", status=replace(STATUS, late_ticks=1)) is Verdict.BAD


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


def test_a_calibration_is_missed_until_every_potentiometer_has_one() -> None:
    (plain,) = examine_table(ParameterTable.defaults(), None)
    assert plain.verdict is Verdict.NOTE
    assert plain.says.startswith("8 potentiometers have the shipped zero")
    some = {f"leader{number}.zero": 8000 for number in range(4)} | {f"follower{n}.scale": -10734 for n in range(3)}
    (one,) = examine_table(ParameterTable.defaults().with_raw(some), None)
    assert one.says.startswith("1 potentiometer has the shipped zero and scale (follower3)")
    (done,) = examine_table(ParameterTable.defaults().with_raw(some | {"follower3.zero": 9000}), None)
    assert done.verdict is Verdict.GOOD
