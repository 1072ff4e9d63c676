"""What a model says about steps: nothing about what was there before, the truth about what it knows, else nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.arm.plants import columns, plant_row
from greywhale.commission.foresee import Foresight, foresee, worsen
from greywhale.commission.limits import COMMISSIONING_LIMITS
from greywhale.commission.trials import Trials
from greywhale.files.arm import default_arm
from greywhale.loop import multi_steps
from greywhale.loop.controllers import controllers_of
from greywhale.measure.swings import unrest
from greywhale.tune.judge.margins import with_gain
from tests.commission.simulated import KD, KI, KP
from tests.support.arms import make_arm
from tools.support.simulated_rig import SimulatedRig


@pytest.fixture
def foresight(trials: Trials, rig: SimulatedRig) -> Foresight:
    before = trials.play_before(lambda: rig)  # type: ignore[arg-type, return-value]
    return foresee(default_arm(), trials.table, trials.check, before.traces, before.measured)


def scaled(trials: Trials, joint: int, factor: float) -> np.ndarray:
    rows = controllers_of(trials.table).copy()
    rows[joint, [KP, KI]] = np.rint(factor * rows[joint, [KP, KI]])
    return rows


def test_the_controllers_from_before_always_pass(trials: Trials, foresight: Foresight) -> None:
    assert foresight.clauses(controllers_of(trials.table)) == ("",) * 4
    assert foresight.ratios(controllers_of(trials.table)) == pytest.approx(np.ones(4), abs=1e-12)


def test_a_joint_that_would_follow_steps_worse_is_named_and_no_other(trials: Trials, foresight: Foresight) -> None:
    clauses = foresight.clauses(scaled(trials, 1, 0.5))
    assert "follows steps worse than before" in clauses[1]
    assert [bool(clause) for clause in clauses] == [False, True, False, False]


def test_a_joint_that_would_swing_after_quick_moves_is_named(trials: Trials, foresight: Foresight) -> None:
    """Joint 3 swings by more than anybody sees on a worse arm; a joint that swung so before is not blamed."""
    foresight = replace(foresight, worse=with_gain(foresight.worse, 3.0))
    rows = controllers_of(trials.table).copy()
    rows[3, [KP, KD]] = 4 * rows[3, KP], rows[3, KD]
    clauses = foresight.clauses(rows)
    assert "may swing after quick moves" in clauses[3]
    assert not any("swing" in clause for clause in clauses[:3])
    (swings,) = foresight.beyond_rest(rows[None])
    assert swings[3] > COMMISSIONING_LIMITS.swings.max_unrest_rad
    before = replace(foresight, unrest=np.tile(1.01 * swings, (2, 1)))
    assert not before.beyond_rest(rows[None]).any()


def test_gaps_beside_play_are_wider_on_the_worse_arm_by_what_estimates_are_off() -> None:
    play = [0.005, 0.0, 0.005, 0.0]
    arm = make_arm(follower_pots={"joint": {joint: {"play": value} for joint, value in enumerate(play)}})
    arm = make_arm(arm, joint_2={"gear": {"half_gap": 0.0, "stiffness": 0.0, "damping": 0.0}})
    doubt = COMMISSIONING_LIMITS.tuning.identification.uncertainty.gap_beside_play_rad
    wider = (worsen(arm, COMMISSIONING_LIMITS) - plant_row(arm))[columns("half_gap")]
    np.testing.assert_allclose(wider, [doubt, 0.0, 0.0, 0.0], atol=1e-15)


def test_a_joint_is_not_blamed_for_its_neighbours(trials: Trials, foresight: Foresight) -> None:
    """A quicker joint 1 disturbs joint 2, whose stiffer controller only makes up for a part of that."""
    rows = scaled(trials, 1, 4.0)
    assert foresight.ratios(rows)[2] > 1.02
    assert not foresight.clauses(rows)[2], "it keeps its controller"
    rows[2] = scaled(trials, 2, 1.1)[2]
    assert foresight.ratios(rows)[2] > COMMISSIONING_LIMITS.steps.max_error_share
    assert not foresight.clauses(rows)[2], "it would be worse without"
    rows[2] = scaled(trials, 2, 0.9)[2]
    assert "follows steps worse" in foresight.clauses(rows)[2]


def test_of_the_rests_between_steps_the_worst_counts(trials: Trials, foresight: Foresight) -> None:
    """The yaw swings from before, but not after every step."""
    rows = controllers_of(trials.table)[None]
    _, restless = foresight.estimate(rows)
    (angles,) = foresight.experiment.run(rows, foresight.plant, every=1).angles
    assert restless[0, 0, 0] > 1.5 * unrest(foresight.experiment.leader, angles.astype(np.float64))[0] > 5e-4


def test_what_is_foreseen_happens_on_the_arm(trials: Trials, rig: SimulatedRig, foresight: Foresight) -> None:
    """The arm is led along the same steps with noise of its own."""
    motion = multi_steps()
    rows = scaled(trials, 1, 0.5)
    errors = []
    for name, table in (("before", trials.table), ("after", trials.table_of(rows))):
        log = rig.play(motion, trials.journal.path(f"{name}.csv"), table, watched=False).log
        errors.append(np.mean((log.leader[:, 1] - log.follower[:, 1]) ** 2))
    assert errors[1] / errors[0] == pytest.approx(foresight.ratios(rows)[1], abs=0.01)
    assert errors[1] / errors[0] > COMMISSIONING_LIMITS.steps.max_error_share


def test_a_model_that_is_wrong_about_quick_moves_is_not_asked(trials: Trials, rig: SimulatedRig) -> None:
    before = trials.play_before(lambda: rig)  # type: ignore[arg-type, return-value]
    error = before.measured.error.copy()
    error[:, 1] *= 1.2
    doubted = replace(before.measured, error=error)
    foresight = foresee(default_arm(), trials.table, trials.check, before.traces, doubted)
    assert foresight.believed.tolist() == [True, False, True, True]
    assert foresight.clauses(scaled(trials, 1, 0.5)) == ("",) * 4


def test_a_trial_with_such_a_joint_does_not_pass(trials: Trials, rig: SimulatedRig, foresight: Foresight) -> None:
    trials.foresight = foresight
    trial = trials.play(lambda: rig, scaled(trials, 1, 0.5))  # type: ignore[arg-type, return-value]
    assert not trial.passed
    assert any("by the model" in fault for fault in trial.verdicts[1].faults)
    assert not any("by the model" in fault for joint in (0, 2, 3) for fault in trial.verdicts[joint].faults)
