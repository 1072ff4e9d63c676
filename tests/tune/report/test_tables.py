"""The paper's tables as text and data: the right number in the right cell, units, and what is not there left out."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from greywhale.base.types import Controllers
from greywhale.files.controller import load
from greywhale.files.paper_tables import paper_table
from greywhale.loop import controller_row
from greywhale.measure import Evaluation, JointMeasures
from greywhale.tune.report import tables
from greywhale.tune.report.tables import Table
from greywhale.tune.result import TuningResult

BEFORE = (0.02, 0.01, 0.004, 0.006)
AFTER = (0.01, 0.012, 0.001, 0.003)


def controllers(name: str) -> Controllers:
    return controller_row(load(paper_table(name)))


def evaluation(mse: tuple[float, ...], rest: float | None = 0.01) -> Evaluation:
    joints = tuple(
        JointMeasures(one, rest, 0.1 + one, None if joint == 3 else 0.05, 1) for joint, one in enumerate(mse)
    )
    return Evaluation(joints, sum(mse), 1000, 5.0, True, (1.0,) * 4)


def row(table: Table, label: str, group: str = "") -> dict[str, float | None]:
    rows: list[dict[str, Any]] = table.as_dict()["rows"]
    found = [one for one in rows if one["row"] == label and one["group"].startswith(group)]
    assert len(found) == 1, (label, group)
    return found[0]


def test_table_8_has_the_scaling_factors_in_the_units_of_the_file() -> None:
    table = tables.scaling_factors(controllers("table_8"))
    assert [one["row"] for one in table.as_dict()["rows"]] == ["K_p", "K_d", "K_i", "K_u"]
    assert row(table, "K_u")["Joint 2"] == 20.0
    assert row(table, "K_p")["Joint 0"] == pytest.approx(1.0427, abs=1e-5)
    printed = next(line.split() for line in table.text().splitlines() if line.startswith("K_p "))
    assert printed == ["K_p", "1.0427", "0.7540", "1.8448", "0.9957"]


def test_table_9_beside_the_papers_own() -> None:
    table = tables.factors_and_sets(controllers("before_tuning"), paper=True)
    assert len(table.as_dict()["rows"]) == 12
    assert row(table, "Pce_trapmf_b")["paper 2"] == pytest.approx(0.6847, abs=1e-4)
    assert row(table, "Pce_trapmf_b")["Joint 2"] == pytest.approx(0.1, abs=1e-4)
    assert "0.01, the least" in table.text()


def test_table_10_prints_a_common_start_once_and_different_starts_each() -> None:
    before, after = controllers("before_tuning"), controllers("table_10")
    common = tables.fuzzy_sets(before, after)
    assert common.as_dict()["columns"] == ["before", "Joint 0", "Joint 1", "Joint 2", "Joint 3"]
    assert row(common, "Ze_trimf_c")["Joint 3"] == pytest.approx(0.0212, abs=1e-4)
    other = before.copy()
    other[1, 0] = -8192
    assert row(tables.fuzzy_sets(other, after), "Ne_trapmf_c")["before 1"] == -0.5


def test_table_11_has_the_three_measures_with_improvement_and_floor() -> None:
    table = tables.step_performance(evaluation(BEFORE), evaluation(AFTER), (1.1, 1.2, 1.3, None, 1.25))
    error = row(table, "All joints", "Mean")
    assert error["before"] == pytest.approx(0.04)
    assert error["lower by %"] == pytest.approx(35.0)
    assert error["x floor"] == 1.25
    assert row(table, "Joint 1", "Mean")["lower by %"] == pytest.approx(-20.0), "worse is negative"
    assert row(table, "Joint 3", "Mean")["x floor"] is None
    assert row(table, "Joint 0", "Steady")["after"] == 0.01
    assert row(table, "Joint 3", "Time delay, onset")["after"] is None
    assert row(table, "Joint 2", "Time delay, correlation")["after"] == pytest.approx(0.101)
    assert "x floor: after tuning as a multiple" in table.text()
    json.dumps(table.as_dict(), allow_nan=False)


def test_joints_that_are_not_in_use_have_no_row_and_no_column() -> None:
    before, after = (replace(evaluation(errors), joints_in_use=(0, 2)) for errors in (BEFORE, AFTER))
    labels = {one["row"] for one in tables.step_performance(before, after).as_dict()["rows"]}
    assert labels == {"Joint 0", "Joint 2", "All joints"}
    sets = tables.fuzzy_sets(controllers("before_tuning"), controllers("table_10"), joints=(0, 2))
    assert sets.as_dict()["columns"] == ["before", "Joint 0", "Joint 2"]


def test_the_papers_tables_11_and_12_add_up_as_printed() -> None:
    for theirs in (tables.PAPER_STEP_MSE, tables.PAPER_MULTI_STEP_MSE):
        for errors in theirs:
            assert sum(errors[:4]) == pytest.approx(errors[4], abs=2.1e-4)
    table = tables.step_performance(evaluation(BEFORE), evaluation(AFTER), paper=True)
    assert row(table, "Joint 1", "Steady")["paper before"] == 0.31
    assert row(table, "Joint 2", "Time delay, onset")["paper after"] == 0.15
    assert row(table, "Joint 2", "Time delay, correlation")["paper after"] is None
    assert max(len(line) for line in table.text().splitlines() if line.startswith("Joint")) <= 80


def test_table_12_shows_a_joint_that_got_worse_and_no_floor_where_none_is_known() -> None:
    table = tables.motion_performance("multi-steps", evaluation(BEFORE), evaluation(AFTER), paper=True)
    assert row(table, "All joints", "Mean")["after"] == pytest.approx(0.026)
    assert row(table, "Joint 2", "Mean")["paper after"] == 0.2364
    assert "floor: " not in table.text()
    assert "multi-steps" in table.title
    perfect = tables.motion_performance("rest", evaluation((0.0,) * 4), evaluation(AFTER))
    assert row(perfect, "Joint 0", "Mean")["lower by %"] is None


@pytest.mark.parametrize(("strategy", "rows"), [("sf", 4), ("both", 12), ("mf", 8)])
def test_a_tuning_fills_the_table_of_its_strategy_and_one_for_every_motion(
    outcome: TuningResult, strategy: str, rows: int
) -> None:
    first, names = outcome.held_out[0], ("steps", "multi-steps", "human-like reaches")
    judged = replace(outcome, strategy=strategy, held_out=tuple(replace(first, name=name) for name in names))
    parameters, steps, multi_steps, human = tables.tables_of(judged, paper=True)
    assert len(parameters.as_dict()["rows"]) == rows
    assert row(steps, "All joints", "Mean")["paper after"] == 0.0405
    assert row(multi_steps, "All joints", "Mean")["paper after"] == 0.4360
    assert "paper after" not in human.as_dict()["columns"]
    assert row(human, "All joints", "Mean")["x floor"] == first.multiples[4]
