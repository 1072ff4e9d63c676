"""The last combination: joints' best count together once they were played; what fails there steps back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greywhale.commission.arm_on_port import ArmOnPort
from greywhale.commission.choose import JointTrials, combine_best, confirm
from greywhale.commission.trials import Trial, Trials
from greywhale.loop.controllers import controllers_of
from tests.commission.simulated import KI, KP
from tests.commission.test_trials import BETTER, WILD, play, play_before, stiffer
from tools.support.simulated_rig import SimulatedRig


def chosen(trials: Trials, joints: list[JointTrials], rig: SimulatedRig, tuned: np.ndarray | None = None) -> Trial:
    """By default the tuning found nothing new."""
    rows = controllers_of(trials.table) if tuned is None else tuned
    return confirm(trials, joints, lambda: rig, rows)  # type: ignore[arg-type, return-value]


def joints_of(trials: Trials) -> list[JointTrials]:
    joints = [JointTrials() for _ in range(4)]
    for trial in trials.done:
        for one, row, verdict in zip(joints, trial.rows, trial.verdicts, strict=True):
            one.add(row, verdict)
    return joints


def test_the_joints_best_are_played_together_before_they_count(trials: Trials, rig: SimulatedRig) -> None:
    play_before(trials, rig)
    play(trials, rig, stiffer(trials, [0, 1], BETTER))
    play(trials, rig, stiffer(trials, [2], BETTER))
    best = chosen(trials, joints_of(trials), rig)
    assert best is trials.done[3]
    assert best.passed
    assert np.array_equal(best.rows, stiffer(trials, [0, 1, 2], BETTER))


class Shaken:
    """In the place of a round's foresight: joints 0 and 1 swing where both are stiff."""

    def __init__(self, stiff: np.ndarray) -> None:
        self.stiff = stiff

    def beyond_rest(self, sets: np.ndarray) -> np.ndarray:
        both = (sets[:, :2] == self.stiff[:2]).all(axis=(1, 2))
        return np.where(both[:, None], [0.01, 0.01, 0.0, 0.0], 0.0)

    def clauses(self, rows: np.ndarray) -> tuple[str, ...]:
        return tuple("swings" if swing else "" for swing in self.beyond_rest(rows[None])[0])


@pytest.mark.parametrize("costs", [(0.2, 0.1), (0.1, 0.2)])
def test_joints_of_different_trials_that_swing_together_are_not_combined(
    trials: Trials, rig: SimulatedRig, costs: tuple[float, float]
) -> None:
    """Each passed beside the other's milder controller. The one that gains less by its stiffer one steps back."""
    before = play_before(trials, rig)
    mild, stiff = (stiffer(trials, [0, 1], factor) for factor in (1.5, BETTER))
    joints = joints_of(trials)
    for joint, stiff_score in enumerate(costs):
        for rows, score in ((mild, 0.3), (stiff, stiff_score)):
            joints[joint].add(rows[joint], replace(before.verdicts[joint], score=score, share=0.5))
    assert np.array_equal(combine_best(trials, joints)[:2], stiff[:2]), "no model speaks against it"
    trials.foresight = Shaken(stiff)  # type: ignore[assignment]
    wanted = mild.copy()
    kept = int(np.argmin(costs))
    wanted[kept] = stiff[kept]
    assert np.array_equal(combine_best(trials, joints), wanted)
    best = chosen(trials, joints, rig)
    assert np.array_equal(best.rows, wanted)
    assert len(trials.done) == 2, "nothing else was played"


@pytest.mark.slow
def test_a_combination_that_fails_on_the_arm_is_not_chosen(trials: Trials, rig: SimulatedRig) -> None:
    """The third joint's controller passed once; from then on the arm is another, on which it hunts."""
    play_before(trials, rig)
    play(trials, rig, stiffer(trials, [1], BETTER))
    joints = joints_of(trials)
    wild = stiffer(trials, [2], WILD)[2]
    joints[2].add(wild, joints[1].ranked()[0].verdict)
    best = chosen(trials, joints, rig)
    assert best.passed
    assert not np.array_equal(best.rows[2], wild)
    assert np.array_equal(best.rows[1], stiffer(trials, [1], BETTER)[1]), "the other joint keeps its better controller"


@pytest.mark.parametrize("ends", [False, True], ids=["another joint fails beside it", "it ends the motion itself"])
def test_what_shakes_others_or_ends_the_motion_steps_back_alone(
    trials: Trials, rig: SimulatedRig, monkeypatch: pytest.MonkeyPatch, ends: bool
) -> None:
    """Joint 1 has two better controllers, joint 2 one, and joint 3 nothing but what was before."""
    before = play_before(trials, rig)
    mild, strong = (stiffer(trials, [1, 2], factor) for factor in (1.5, BETTER))
    joints = joints_of(trials)
    for joint, rows, score in ((1, mild, 0.5), (1, strong, 0.2), (2, mild, 0.5)):
        joints[joint].add(rows[joint], replace(before.verdicts[joint], score=score))

    def play(rig: ArmOnPort | None, rows: np.ndarray) -> Trial:
        verdicts = [replace(one, score=0.9) for one in before.verdicts]
        if np.array_equal(rows[1], strong[1]):
            verdicts = [replace(one, known=not ends, passes_at_a_price=not ends) for one in verdicts]
            verdicts[1 if ends else 3] = replace(verdicts[3], known=True, passes_at_a_price=False)
        trials.done.append(replace(before, rows=rows.copy(), verdicts=tuple(verdicts)))
        return trials.done[-1]

    monkeypatch.setattr(trials, "play", play)
    best = chosen(trials, joints, rig)
    assert np.array_equal(best.rows[1], mild[1])
    assert np.array_equal(best.rows[2], mild[2]) == ends


def test_where_nothing_passes_what_was_before_is_chosen(trials: Trials, rig: SimulatedRig) -> None:
    before = play_before(trials, rig)
    play(trials, rig, stiffer(trials, [1], WILD))
    assert chosen(trials, joints_of(trials), rig) is before


def test_a_tuned_controller_is_played_before_a_joint_keeps_what_it_had(trials: Trials, rig: SimulatedRig) -> None:
    """The set that the search found hunts, and nothing else was tried."""
    play_before(trials, rig)
    play(trials, rig, stiffer(trials, [1], WILD))
    tuned = stiffer(trials, [0, 1], BETTER)
    best = chosen(trials, joints_of(trials), rig, tuned)
    assert np.array_equal(best.rows, tuned)
    assert best.passed


def test_a_joint_that_hunted_gets_its_tuned_controller_then_ever_softer_ones(trials: Trials, rig: SimulatedRig) -> None:
    play_before(trials, rig)
    joint, before = joints_of(trials)[0], controllers_of(trials.table)[0]
    hunts = replace(joint.tried[0].verdict, restless=True, faults=("joint 0 hunted",), passes_at_a_price=False)
    searched, tuned = before.copy(), before.copy()
    searched[[KP, KI]], tuned[[KP, KI]] = (6 * before[KP], 100), (4 * before[KP], 900)
    shares, met = (1.0, 0.5, 0.25), list[np.ndarray]()
    for row in (searched, None, None, None):
        joint.add(met[-1] if row is None else row, hunts)
        met.append(joint.calmer(tuned, shares))
    assert [row[KP] / before[KP] for row in met] == pytest.approx([4.0, 2.5, 1.75, 1.0], rel=1e-3)
    assert [row[KI] for row in met[:3]] == [100] * 3, "no integral part above that which hunted"
    assert np.array_equal(met[3], before)
