"""Logs as they come: rows missing, late or few, long rest, full voltage, and people who press Ctrl-C."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import Drive
from greywhale.base.errors import UserError
from greywhale.files.arm import load_arm
from greywhale.identify import IdentificationResult, identify
from greywhale.identify.checks import check
from greywhale.identify.data import prepare, windows_of
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.loop import human_reaches, multi_steps
from greywhale.protocol.table import ParameterTable
from tests.identify.conftest import alone, rows, without
from tests.support.interrupts import ctrl_c_at
from tools.support.recordings import Recorded, record

WEAK_V = 5.0


@pytest.mark.slow
def test_rows_that_are_few_uneven_and_partly_missing_will_do(shoulder_outcome: IdentificationResult) -> None:
    assert shoulder_outcome.verdicts[1].improvement > 0.9


@pytest.mark.slow
def test_a_log_of_steps_on_a_weak_supply_full_voltage_or_rest_will_do(
    hidden: ArmParameters, white_box: ArmParameters, tables: list[ParameterTable], tmp_path: Path
) -> None:
    table = tables[0].with_raw({"supply_mv": round(1000 * WEAK_V)})
    arm, user = (one.model_copy(update={"drive": Drive(supply=WEAK_V)}) for one in (hidden, white_box))
    log = record(arm, alone(multi_steps([0.0, 1.0, -0.6], [1.0, 2.5, 2.5])), tmp_path / "steps.csv", table)
    second = record(arm, alone(human_reaches(7, 8.0)), tmp_path / "second.csv", table, 3)
    moving = np.abs(prepare(log, 1).velocity[:, 1]) > 0.2
    assert np.mean(np.abs(log.voltage[moving, 1]) > 0.99 * WEAK_V) > 0.4
    assert np.mean(moving) < 0.5
    outcome = identify([log], user, validate=[second], tables=[table])
    assert outcome.verdicts[1].improvement > 0.9


def test_lost_rows_neither_end_a_stretch_nor_look_like_another_period(
    recorded: Recorded, white_box: ArmParameters
) -> None:
    whole, log = prepare(recorded.fit, 1), prepare(without(recorded.fit, 0.1), 1)
    assert len(log.runs) == len(whole.runs) == 1
    np.testing.assert_allclose(log.noise, whole.noise, rtol=0.15)
    inside = slice(100, -100)
    truth = np.interp(log.log.time, whole.log.time, whole.velocity[:, 1])
    assert np.std((log.velocity[:, 1] - truth)[inside]) < 0.1 * np.std(truth)
    ten = rows(recorded.fit, slice(0, None, 1))
    held = np.repeat(ten.voltage[::10], 10, axis=0)[: len(ten.time)]
    slow = replace(ten, voltage=held, origin=replace(ten.origin, period_ms=10, param_crc=None))
    assert check(prepare(without(slow, 0.02), 1), white_box, None) == []
    with pytest.raises(UserError, match=r"changes every 10 ms, but the control period is stated as 7 ms"):
        check(prepare(replace(slow, origin=replace(slow.origin, period_ms=7)), 1), white_box, None)


def test_a_long_gap_ends_a_stretch_and_no_window_crosses_it(recorded: Recorded) -> None:
    gap = round(2 * IDENTIFICATION_LIMITS.data.longest_gap_s * 1000)
    kept = np.ones(len(recorded.fit.time), dtype=bool)
    kept[4000 : 4000 + gap] = False
    prepared = prepare(rows(recorded.fit, kept), 1)
    assert [run.stop for run in prepared.runs] == [4000, len(prepared.log.time)]
    windows = windows_of(prepared)
    assert not any(first < 4000 < first + windows.rows for first in windows.first)
    shredded = np.arange(len(recorded.fit.time)) % 400 > gap
    with pytest.raises(UserError, match=r"only 0\.0 s of it can be used"):
        check(prepare(rows(recorded.fit, shredded), 1), load_arm("white_box"), None)


@pytest.mark.slow
@pytest.mark.parametrize(
    "moment", ["least squares from several", "choosing the model's order", "fitting the chosen", "judging the model"]
)
def test_ctrl_c_at_any_moment_keeps_the_best_model_so_far(
    shoulder: Recorded, white_box: ArmParameters, tables: list[ParameterTable], tmp_path: Path, moment: str
) -> None:
    outcome = identify([rows(shoulder.fit, slice(5000))], white_box, tables=tables, report=ctrl_c_at(moment))
    assert not outcome.complete
    assert outcome.text().startswith("UNFINISHED")
    outcome.save(tmp_path / "model.toml")
    facts = load_arm(tmp_path / "model.toml").identification
    assert facts is not None
    assert facts["status"].startswith("unfinished")
    # Motors alone are worse than nothing without their friction; from then on there is a model worth keeping.
    assert (outcome.verdicts[0].improvement > 0.8) is (not moment.startswith("least squares"))
