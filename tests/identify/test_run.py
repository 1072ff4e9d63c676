"""The default method on an arm that it does not know: what it reaches, what it writes, what it leaves open."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import PITCH_JOINTS
from greywhale.arm.plants import column
from greywhale.files.arm import load_arm
from greywhale.files.log.condition import Condition
from greywhale.identify import IdentificationResult, identify, validated
from greywhale.identify import judge as judging
from greywhale.identify.excite import design
from greywhale.identify.judge import CHANGED, FIT, SECOND, LogVerdict, judge, undecided_of, warnings_of
from greywhale.identify.limits import IDENTIFICATION_LIMITS
from greywhale.identify.uncertainty import LARGEST_CONDITION
from greywhale.loop import human_reaches, plant_row
from greywhale.protocol.table import ParameterTable
from greywhale.tune.model import load_model
from tests.identify.conftest import alone, first, rows, simulated_logs
from tests.support.interrupts import ctrl_c_at
from tests.support.limits import copy_of, reads_of
from tools.support.recordings import Recorded, record


@pytest.mark.slow
def test_model_predicts_other_logs_far_better_than_the_white_box(outcome: IdentificationResult) -> None:
    assert [verdict.role for verdict in outcome.verdicts] == [FIT, SECOND, CHANGED]
    assert outcome.verdicts[1].improvement > 0.97
    assert outcome.verdicts[2].improvement > 0.9
    assert outcome.complete
    assert outcome.warnings == ()


@pytest.mark.slow
def test_search_can_go_on_from_a_model_of_the_same_arm(
    outcome: IdentificationResult,
    shoulder: Recorded,
    white_box: ArmParameters,
    tables: list[ParameterTable],
    tmp_path: Path,
) -> None:
    """With two short logs of one joint; a third, which it has not seen, is predicted well."""
    outcome.save(tmp_path / "model.toml")
    begin = load_arm(tmp_path / "model.toml")
    logs = [first(shoulder.fit, 5.0), first(shoulder.changed, 5.0)]
    more = identify(logs, white_box, validate=[shoulder.second], tables=tables, begin=begin)
    orders = [order for order, _ in more.found.orders]
    assert orders[:3] == ["motors", "Coulomb friction", outcome.found.order], "nothing in between is tried again"
    role_of_second = {verdict.role: verdict for verdict in more.verdicts}[SECOND]
    assert role_of_second.improvement > 0.97
    assert more.complete


@pytest.mark.slow
def test_motors_come_out_as_they_are(outcome: IdentificationResult, hidden: ArmParameters) -> None:
    """Speed per volt and friction in volts are what such logs show best; torque per volt only where gravity acts."""
    for joint in range(4):
        true = hidden.actuator(joint)
        found = {one.name: one.value for one in outcome.estimates}
        assert found[f"joint{joint}.damping"] == pytest.approx(true.damping / true.torque_per_volt, rel=0.15)
        friction = hidden.joint[joint].friction.coulomb / true.torque_per_volt
        assert found[f"joint{joint}.coulomb"] == pytest.approx(friction, rel=0.35)
    for joint in PITCH_JOINTS:
        assert found[f"joint{joint}.alpha"] == pytest.approx(1.0 / hidden.actuator(joint).torque_per_volt, rel=0.1)
    assert all(one.deviation is not None and one.deviation >= 0.0 for one in outcome.estimates)
    assert outcome.found.condition is not None
    assert outcome.found.condition > 1.0


@pytest.mark.slow
def test_order_is_chosen_by_held_out_data(outcome: IdentificationResult) -> None:
    """Coulomb friction must be seen to be worth it: this arm has a lot."""
    errors = dict(outcome.found.orders)
    assert errors["Coulomb friction"] < 0.5 * errors["motors"]
    # So short a log may show a yaw with three times the torque a little better; the arm file outweighs that.
    assert errors[outcome.found.order] <= min(errors.values()) + 0.2


@pytest.mark.slow
def test_model_file_is_an_arm_file(outcome: IdentificationResult, tables: list[ParameterTable], tmp_path: Path) -> None:
    outcome.save(tmp_path / "model.toml")
    arm = load_arm(tmp_path / "model.toml")
    np.testing.assert_allclose(plant_row(arm), outcome.plant, rtol=1e-9, atol=1e-12)
    facts = arm.identification
    assert facts is not None
    assert facts["status"] == "complete"
    assert facts["method"] == "default"
    assert [one["role"] for one in facts["log"]] == [FIT, SECOND, CHANGED]
    assert facts["log"][0]["parameter_crc"].startswith("0x")
    assert facts["log"][0]["period_ms"] == 1
    assert facts["log"][0]["model_mse_rad2"] == pytest.approx(outcome.verdicts[0].model)
    assert facts["parameters"] == tables[0].changes()
    named = {one["name"]: one for one in facts["parameter"]}
    assert named["joint0.damping"]["standard_deviation"] > 0.0
    assert isinstance(facts["fisher_condition"], float)


@pytest.mark.slow
def test_logs_that_come_later_judge_as_those_that_were_there(
    outcome: IdentificationResult, recorded: Recorded, tables: list[ParameterTable]
) -> None:
    early = replace(outcome, subjects=outcome.subjects[:1], verdicts=outcome.verdicts[:1], warnings=("early",))
    late = validated(early, [recorded.second, recorded.changed], tables[1:])
    assert late.identification() == outcome.identification()


@pytest.mark.slow
def test_what_is_not_known_is_said_with_a_remedy(outcome: IdentificationResult) -> None:
    """Yaw and roll feel no gravity; whatever is named open must name its joint and a motion that would settle it."""
    wide = [
        one.name
        for one in outcome.estimates
        if one.name.endswith(("alpha", "inertia", "damping", "coulomb", "stribeck"))
        and one.deviation is not None
        and one.deviation > 0.35 * one.value
    ]
    for name in wide:
        joint, _, kind = name.partition(".")
        assert any(f"joint {joint[5:]} " in sentence and kind in sentence for sentence in outcome.found.open)
    assert all(";" in sentence for sentence in outcome.found.open)


@pytest.mark.slow
def test_joints_that_did_not_move_keep_the_users_values(
    shoulder_outcome: IdentificationResult, white_box: ArmParameters
) -> None:
    outcome = shoulder_outcome
    for joint in (0, 2, 3):
        start = column("torque_per_volt", joint)
        np.testing.assert_array_equal(outcome.plant[start : start + 12], plant_row(white_box)[start : start + 12])
        assert any(f"joint {joint} " in sentence and "did not move" in sentence for sentence in outcome.found.open)
        assert outcome.verdicts[0].model[joint] == 0.0
    assert {one.name[5] for one in outcome.estimates} == {"1"}
    assert outcome.verdicts[0].improvement > 0.9


@pytest.mark.slow
def test_without_its_controller_a_log_is_still_worth_something(shoulder: Recorded, white_box: ArmParameters) -> None:
    """Only the logged voltages remain; at a tenth of the rows, as another tool may log."""
    origin = replace(shoulder.fit.origin, param_crc=None, firmware=None, every_ticks=10)
    old = Condition(remarks=("it has no check.",))
    log = rows(replace(first(shoulder.fit, 4.5), origin=origin, condition=old), slice(None, None, 10))
    outcome = identify([log], white_box)
    assert outcome.verdicts[0].measure.startswith("logged voltages")
    assert outcome.verdicts[0].improvement > 0.8
    assert outcome.warnings[0] == f"{log.name}: it has no check."
    assert any("controller is not known" in warning for warning in outcome.warnings)


def test_interrupt_before_any_model_is_an_interrupt(recorded: Recorded, white_box: ArmParameters) -> None:
    with pytest.raises(KeyboardInterrupt):
        identify([recorded.fit], white_box, report=ctrl_c_at("fitting the motors"))


def verdict(role: str, white_box: float, model: float, chance: float = 0.0) -> LogVerdict:
    return LogVerdict("a", role, "closed loop", (1.0, white_box, 0.0, 0.0), (model, white_box, 0.0, 0.0), chance=chance)


def test_model_that_learnt_its_controller_is_warned_about() -> None:
    good = [verdict(FIT, 0.0, 0.1), verdict(SECOND, 0.0, 0.2)]
    assert warnings_of([*good, verdict(CHANGED, 0.0, 0.3)]) == []
    assert any("learnt that controller" in one for one in warnings_of([*good, verdict(CHANGED, 0.0, 1.5)]))
    worse = warnings_of([good[0], verdict(SECOND, 0.0, 2.0), verdict(CHANGED, 0.0, 1.5)])
    assert len(worse) == 2
    assert all("worse than the arm file" in one for one in worse)


def test_chance_decides_whether_a_model_is_worse() -> None:
    near, worse, better = (verdict(SECOND, 1.0, model, 0.3) for model in (1.2, 1.4, 0.4))
    assert [one.is_as_good for one in (near, worse, better)] == [True, False, False]
    assert [one.is_worse for one in (near, worse, better)] == [False, True, False]
    assert warnings_of([near, better]) == []
    assert "by more than chance excuses (2.4 against 2 rad²)" in warnings_of([worse])[0]


@pytest.mark.parametrize("chance", [2.5, 50.0, 1e6])
@pytest.mark.parametrize(
    ("times", "words"), [(24.4, "24.4 times worse"), (3.0, "3 times worse"), (0.1, "90.0 % better")]
)
def test_a_less_certain_model_is_not_judged_more_kindly(chance: float, times: float, words: str) -> None:
    """Its uncertainty excuses no more than the white box's own error."""
    one = replace(verdict(SECOND, 0.0, times, chance), white_box=(1.0, 0.0, 0.0, 0.0))
    assert one.is_worse is (times > 2.0)
    assert not one.is_as_good
    assert one.comparison == words
    assert "these logs decide nothing" in undecided_of([one])[0]
    certain = replace(one, chance=0.3)
    assert undecided_of([certain]) == []
    assert certain.is_worse is (times > 1.3)


@pytest.mark.parametrize("model", [1e-5, 9e-5])
def test_chance_decides_where_nobody_cares_for_the_difference(model: float) -> None:
    """A white box that is exact has the error of the converter's steps alone."""
    one = replace(verdict(SECOND, 0.0, model, 9.5e-5), white_box=(9e-6, 0.0, 0.0, 0.0))
    assert one.is_as_good
    assert not one.is_worse
    assert undecided_of([one]) == []


@pytest.mark.slow
def test_ctrl_c_while_logs_are_judged_keeps_the_model(
    shoulder: Recorded, white_box: ArmParameters, tables: list[ParameterTable], monkeypatch: pytest.MonkeyPatch
) -> None:
    pressed = iter([True])

    def judge_or_stop(*given: Any) -> LogVerdict:
        if next(pressed, False):
            raise KeyboardInterrupt
        return judge(*given)

    monkeypatch.setattr(judging, "judge", judge_or_stop)
    found = identify([first(shoulder.fit, 5.0)], white_box, validate=[shoulder.second], tables=tables)
    assert found.text().startswith("UNFINISHED")
    assert len(found.verdicts) == 2


@pytest.mark.slow
def test_a_condition_number_beyond_rounding_is_told_as_a_least(outcome: IdentificationResult) -> None:
    told = [
        next(line for line in replace(outcome, found=replace(outcome.found, condition=value)).text().splitlines()
             if line.startswith("Condition number"))
        for value in (2e6, LARGEST_CONDITION)
    ]  # fmt: skip
    assert "information: 2e+06. " in told[0]
    assert "information: at least 1e+13. " in told[1]


@pytest.mark.slow
def test_chance_is_what_plants_that_the_fit_allows_are_worse_by(
    outcome: IdentificationResult, white_box: ArmParameters
) -> None:
    """It is far below what the white box is off, and the converter's steps where the fit allows its estimate alone."""
    second, found = outcome.subjects[1], outcome.found
    assert found.draws is not None
    same = judge(second, white_box, found.plant, found.zero, found.joints, np.tile(found.plant, (5, 1)))
    steps = 4 * (np.radians(300.0) / 1024) ** 2 / 12
    assert same.chance == pytest.approx(steps)
    assert judge(second, white_box, found.plant, found.zero, found.joints).chance == pytest.approx(steps)
    few = judge(second, white_box, found.plant, found.zero, (0, 2))
    assert few.chance == pytest.approx(steps / 2)
    draws = found.draws[:20]
    spread = [judge(second, white_box, draw, found.zero, found.joints) for draw in draws]
    chance = judge(second, white_box, found.plant, found.zero, found.joints, draws).chance - steps
    beyond = [one for one in spread if sum(one.model) - sum(same.model) > chance]
    assert len(beyond) == round(0.05 * len(draws))
    assert 0.0 < outcome.verdicts[1].chance < 0.25 * sum(outcome.verdicts[1].white_box)


@pytest.mark.slow
@pytest.mark.parametrize("begun", ["model", "exact"])
def test_second_round_is_as_good_as_the_arm_that_it_began_with(
    outcome: IdentificationResult, recorded: Recorded, hidden: ArmParameters, tables: list[ParameterTable],
    tmp_path: Path, begun: str,
) -> None:  # fmt: skip
    """A model of before, or an arm file that is exact: there is little to learn, and that is no fault."""
    arm = outcome.arm if begun == "model" else hidden
    if begun == "model":
        outcome.save(tmp_path / "model.toml")
        arm = load_arm(tmp_path / "model.toml")
    more = record(hidden, alone(human_reaches(77, 12.0)), tmp_path / "more.csv", tables[0], 77)
    again = identify([more], arm, validate=[recorded.second, recorded.changed], tables=tables)
    assert not any(verdict.is_worse for verdict in again.verdicts)
    assert again.warnings == ()
    again.save(tmp_path / "again.toml")
    text = again.text()
    doubts = load_model(tmp_path / "again.toml", force=True).doubts
    assert len(doubts) == 1
    assert "no motor moved joint 0 (base yaw) and joint 2 (wrist pitch) and joint 3 (wrist roll) in its" in doubts[0]
    if begun == "model":
        assert "white box" not in text
        assert "as good as the model before, as far as noise lets tell" in text
        assert again.arm.name == outcome.arm.name
    judged = [line for line in text.splitlines() if line.startswith("all joints")]
    assert not [line for line in judged if " -" in line], "a loss in percent"


@pytest.mark.slow
def test_an_identification_reads_no_limits_but_those_that_it_was_handed(
    shoulder: Recorded, white_box: ArmParameters, tables: list[ParameterTable]
) -> None:
    """Nor does what is validated afterwards, or the design of a motion."""
    own, log = copy_of(IDENTIFICATION_LIMITS), first(shoulder.fit, 5.0)
    with reads_of(IDENTIFICATION_LIMITS) as read, simulated_logs(1):
        found = identify([log], white_box, validate=[shoulder.second], tables=tables, judging=own)
        validated(found, [shoulder.changed], tables)
        identify([log], white_box, tables=tables, method="gwo-woa", judging=own)
        design(white_box, [0.0, 0.4, 0.0, 0.0], seconds=5.0, budget=2, judging=own).text()
    assert read == set()


@pytest.mark.slow
def test_a_stricter_search_takes_fewer_orders(
    shoulder: Recorded, white_box: ArmParameters, tables: list[ParameterTable]
) -> None:
    """An ablation is a loop: no code is patched."""
    log, names = first(shoulder.fit, 5.0), []
    for least in (0.01, 1e9):
        strict = replace(IDENTIFICATION_LIMITS.search, min_improvement=least)
        found = identify([log], white_box, tables=tables, judging=replace(IDENTIFICATION_LIMITS, search=strict))
        names.append(found.found.order)
    assert names[0] != names[1] == "motors"
