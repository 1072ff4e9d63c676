"""Every kind of useless log is refused in one sentence that names file, joint and evidence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.base.types import show_no_progress
from greywhale.files import parameter_file
from greywhale.files.log import Log
from greywhale.files.log.check import Check
from greywhale.files.log.condition import Condition
from greywhale.files.log.layout import Origin
from greywhale.files.parameter_file import load_table
from greywhale.identify import identify
from greywhale.identify.checks import check
from greywhale.identify.controllers import table_of
from greywhale.identify.data import prepare
from greywhale.identify.judge import FIT, JudgedLog
from greywhale.identify.request import IdentificationRequest
from greywhale.protocol.schema import Board
from greywhale.protocol.table import ParameterTable
from tests.identify.conftest import rows
from tools.support.recordings import TABLES, Recorded
from tools.support.recordings import table_of as values_of


def milliseconds(log: Log) -> Log:
    return replace(log, time=1000.0 * log.time, origin=replace(log.origin, period_ms=None))


def minutes(log: Log) -> Log:
    return replace(log, time=log.time / 60.0, origin=replace(log.origin, period_ms=None))


def short(log: Log) -> Log:
    return rows(log, slice(2000))


def still(log: Log) -> Log:
    return replace(log, follower=0.1 + 0.02 * log.follower)


def clipped(log: Log) -> Log:
    follower = log.follower.copy()
    follower[:, 2] = np.minimum(4.0 * follower[:, 2] + 2.0, 2.5)
    return replace(log, follower=follower)


def swapped(log: Log) -> Log:
    return replace(log, leader=log.follower, follower=log.leader)


def overdriven(log: Log) -> Log:
    return replace(log, voltage=1.5 * np.sign(log.voltage) * 15.0)


def slower(log: Log) -> Log:
    return replace(log, origin=replace(log.origin, period_ms=20))


def off(log: Log) -> Log:
    """Somebody moved the arm by hand."""
    return replace(log, voltage=0.0 * log.voltage, state=np.full(len(log.time), "disabled"))


def led_in_vain(log: Log) -> Log:
    """The motors had no supply."""
    return replace(log, follower=0.01 * log.follower)


def barely_powered(log: Log) -> Log:
    """The motors ran for the last second, and nothing says when they followed."""
    voltage = np.where(log.time[:, None] > log.time[-1] - 1.0, log.voltage, 0.0)
    return replace(off(log), voltage=voltage)


def without_voltage(log: Log, *joints: int) -> Log:
    voltage = log.voltage.copy()
    voltage[:, joints] = 0.0
    return replace(log, voltage=voltage)


def three_of_four_at_rest(log: Log) -> Log:
    """The joint that moves has no voltage."""
    follower = log.follower.copy()
    follower[:, 1:] *= 0.0
    return replace(without_voltage(log, 0), follower=follower)


@pytest.mark.parametrize(
    ("spoil", "evidence"),
    [
        (off, r"the motors were off in all 9.04 s \(state disabled, 0 V\), .*record --enable"),
        (led_in_vain, r"no joint moved: .* the leader moved by \d.* rad, so check the motors' supply"),
        (barely_powered, r"only 2\.0 s of it"),
        (three_of_four_at_rest, r"joint 0 had 0 V in every row, while its leader moved by \d.* rad and its follower"),
        (milliseconds, r"its rows are 1 s apart, but at most 0\.1 s show .* is time_s in ms\?"),
        (minutes, r"only 0\.0 s of it .* apart, which no measure .* is time_s in min\?"),
        (short, r"only 2\.0 s of it .* at least 4 s"),
        (still, r"no joint moved: joints 0\.\.3 stayed within 0\.\d+, .* rad"),
        (clipped, r"joint 2 is clipped: its follower reads exactly 2\.5000 rad in \d+ %"),
        (swapped, r"joint \d looks as if leader and follower columns were swapped .*correlation .* -0\.\d\d"),
        (overdriven, r"joint \d was driven with 22\.50 V, but drive\.supply .* 15 V"),
        (slower, r"joint \d: the voltage changes every 1 ms, but the control period is stated as 20 ms"),
    ],
)
def test_useless_logs_are_refused(
    recorded: Recorded, white_box: ArmParameters, spoil: Callable[[Log], Log], evidence: str
) -> None:
    log = spoil(recorded.fit)
    with pytest.raises(UserError, match=evidence) as refused:
        check(prepare(log, 1), white_box, None)
    assert refused.value.message.startswith(log.name)
    with pytest.raises(UserError, match=evidence):
        identify([replace(log, origin=replace(log.origin, param_crc=None))], white_box)


def test_good_logs_pass_without_doubt(
    recorded: Recorded, white_box: ArmParameters, tables: list[ParameterTable]
) -> None:
    for log in (recorded.fit, recorded.second, recorded.changed):
        assert check(prepare(log, 1), white_box, table_of(log, tables)) == []


@pytest.mark.parametrize("word", ["disabled", "fault", "boot"])
def test_a_log_of_another_tool_needs_voltages_but_no_states(
    recorded: Recorded, white_box: ArmParameters, word: str
) -> None:
    log = replace(recorded.fit, state=np.full(len(recorded.fit.time), word))
    prepared = prepare(log, None)
    assert check(prepared, white_box, None) == []
    np.testing.assert_array_equal(prepared.velocity, prepare(recorded.fit, None).velocity)


def test_a_joint_without_voltage_is_not_identified_and_named(recorded: Recorded, white_box: ArmParameters) -> None:
    prepared = prepare(without_voltage(recorded.fit, 0, 2), 1)
    doubts = check(prepared, white_box, None)
    assert [one.partition(" had 0 V")[0] for one in doubts] == [
        f"{recorded.fit.name}: joint {joint}" for joint in (0, 2)
    ]
    request = IdentificationRequest(white_box, (JudgedLog(prepared, None, FIT),), 0, show_no_progress)
    assert request.moving == (1, 3)


@pytest.mark.parametrize("validates", [False, True])
def test_a_log_in_which_an_identified_joint_has_no_voltage_is_refused(
    recorded: Recorded, white_box: ArmParameters, tables: list[ParameterTable], validates: bool
) -> None:
    """It would say that the joint moves by itself."""
    log = without_voltage(recorded.second, 0)
    fit, validate = ([recorded.fit], [log]) if validates else ([recorded.fit, log], [])
    with pytest.raises(UserError, match=f"^{log.name}: joint 0 had 0 V .* another log shows .* leave this one out"):
        identify(fit, white_box, validate=validate, tables=tables)


def test_full_voltage_most_of_the_time_is_a_doubt_only(recorded: Recorded, white_box: ArmParameters) -> None:
    log = replace(recorded.fit, voltage=15.0 * np.sign(recorded.fit.leader - recorded.fit.follower))
    doubts = check(prepare(log, 1), white_box, None)
    assert doubts
    assert all("full voltage" in one for one in doubts)


def test_controllers_are_found_by_their_crc(recorded: Recorded, tables: list[ParameterTable]) -> None:
    defaults = ParameterTable.defaults()
    assert table_of(recorded.changed, tables) == tables[1]
    assert table_of(recorded.fit, tables) == tables[0]
    assert table_of(
        replace(recorded.fit, origin=Origin(board="nano328", param_crc=defaults.crc)), []
    ) == defaults.for_board(Board.NANO328)
    assert table_of(recorded.changed, []) is None
    itself = replace(recorded.changed.origin, table=tables[1])
    for given in ([], [tables[0]], tables):
        assert table_of(replace(recorded.changed, origin=itself), given) == tables[1]
    alone = replace(itself, param_crc=None)
    assert table_of(replace(recorded.changed, origin=alone), [tables[0]]) == tables[1]


@pytest.mark.parametrize("validates", [False, True])
def test_a_log_whose_rows_were_changed_is_refused(
    recorded: Recorded, white_box: ArmParameters, validates: bool
) -> None:
    """Also one that only judges the model."""
    log = replace(recorded.fit, condition=Condition(Check.CHANGED, remarks=("its check fails.",)))
    fit, validate = ([recorded.second], [log]) if validates else ([log], [])
    with pytest.raises(UserError, match=f"^{log.name}: its check fails"):
        identify(fit, white_box, validate=validate)


def test_another_controller_than_the_logs_is_refused(recorded: Recorded, white_box: ArmParameters) -> None:
    paper = values_of("table_10")
    other = paper.with_raw({"joint1.ku_mv": paper["joint1.ku_mv"] - 1}).with_name("other.toml")
    with pytest.raises(UserError, match=r"0x\w{4}, but .* other.toml 0x\w{4}"):
        identify([recorded.changed], white_box, tables=[other])
    without = replace(recorded.fit, origin=Origin(period_ms=20))
    with pytest.raises(UserError, match="20 ms, but other.toml has 1 ms"):
        table_of(without, [other])
    with pytest.raises(UserError, match="only one --controller"):
        table_of(without, [other, other])


def test_tables_come_from_controller_files_and_backups(tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("tables") / "backup.toml"
    parameter_file.save(path, values_of("table_10"))
    assert load_table(path) == load_table(TABLES / "table_10.toml") == values_of("table_10")
