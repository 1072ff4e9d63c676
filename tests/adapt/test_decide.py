"""What runs, what is kept and what goes back, with real stretches of work and proposals made by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greywhale.adapt.decide import Adaptation, Outcome
from greywhale.adapt.foresee import foresee, judged_of
from greywhale.adapt.gain import Scale
from greywhale.adapt.limits import ADAPTATION_LIMITS, AdaptationLimits
from greywhale.adapt.live_model import LiveModel
from greywhale.adapt.propose import Proposal, Task, work_on
from greywhale.base.types import Controllers
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.table import CONTROLLER_COLUMNS
from greywhale.tune.model import Model
from tests.adapt.conftest import TABLE
from tests.adapt.simulated import Work, with_gain, work_for
from tests.support.arms import make_arm

pytestmark = pytest.mark.slow
BEFORE = controllers_of(TABLE)
PIECES = 4  # of seven stretches: enough for a search


def stiffer(factor: float) -> Controllers:
    rows = BEFORE.copy()
    place = CONTROLLER_COLUMNS.index("kp")
    rows[:, place] = np.round(factor * rows[:, place])
    return rows


def proposal_of(task: Task, rows: Controllers, predicted: float = 0.5, spread: float = 0.0) -> Proposal:
    """What the background would say of a set that somebody else found."""
    before = foresee(task.live, task.table, controllers_of(task.table), task.recent, task.live.plants[:1])[0]
    measured = np.array([one.error for one in judged_of(task.recent)])
    return Proposal(task.live, rows, predicted, spread, Scale.of(measured, before))


def task_after_work(adaptation: Adaptation, work: Work) -> Task:
    work_for(adaptation, work, PIECES)
    task = adaptation.task()
    assert task is not None
    return task


def propose(adaptation: Adaptation, work: Work, factor: float, predicted: float = 0.5, spread: float = 0.0) -> None:
    """Have a set with so many times the stiffness found for what was seen."""
    adaptation.answer(proposal_of(task_after_work(adaptation, work), stiffer(factor), predicted, spread))


def test_a_search_begins_once_enough_was_seen_and_only_one_at_a_time(adaptation: Adaptation, work: Work) -> None:
    work_for(adaptation, work, 2)
    assert adaptation.task() is None
    task = task_after_work(adaptation, work)
    assert len(judged_of(task.recent)) >= ADAPTATION_LIMITS.decisions.first_search_s
    work_for(adaptation, work, 2)
    assert adaptation.task() is None, "one is under way"
    adaptation.answer(proposal_of(task, BEFORE, 1.0))
    assert adaptation.wish is None
    assert adaptation.task() is not None


def test_who_does_not_work_is_not_searched_for(adaptation: Adaptation, work: Work) -> None:
    still = work.follow(TABLE, np.zeros((1000, 4)), 1)
    for stretch in work.piece(TABLE) * PIECES:
        adaptation.take(type(stretch)(stretch.begins_s, True, *still))
    assert adaptation.task() is None


def test_a_better_set_is_tried_and_kept(adaptation: Adaptation, work: Work) -> None:
    propose(adaptation, work, 1.6)
    wish = adaptation.wish
    assert wish is not None
    assert not wish.urgent
    assert adaptation.standby == wish.table
    work_for(adaptation, work, 1)
    assert adaptation.running == wish.table
    assert adaptation.standby == TABLE, "what a bad set gives way to is at hand"
    work_for(adaptation, work, 4)
    (tried,) = adaptation.trials
    assert tried.outcome is Outcome.KEPT
    assert tried.high is not None
    assert tried.high < 1.0
    assert adaptation.kept == adaptation.running == wish.table


def test_a_worse_set_goes_back_within_seconds(adaptation: Adaptation, work: Work) -> None:
    """Whatever a model promises."""
    propose(adaptation, work, 0.4)
    work_for(adaptation, work, 1)
    assert adaptation.running != TABLE
    for stretch in work.piece(adaptation.running):
        adaptation.take(stretch)
        if adaptation.wish is not None:
            break
    (tried,) = adaptation.trials
    assert tried.outcome is Outcome.WORSE
    assert tried.seconds <= 7
    assert adaptation.wish is not None
    assert adaptation.wish.urgent
    assert adaptation.wish.table == adaptation.kept == TABLE


def deciding(**other: Any) -> AdaptationLimits:
    """The usual limits, but for some of the decisions'."""
    return replace(ADAPTATION_LIMITS, decisions=replace(ADAPTATION_LIMITS.decisions, **other))


def test_a_set_that_is_the_same_goes_back_untold(model: Model, work: Work) -> None:
    adaptation = Adaptation(model, TABLE, budget=1, limits=deciding(max_trial_s=28))
    propose(adaptation, work, 1.001)
    work_for(adaptation, work, 1)
    work_for(adaptation, work, 6)
    (tried,) = adaptation.trials
    assert tried.outcome is Outcome.INCONCLUSIVE
    assert adaptation.running == TABLE


def test_after_a_wrong_promise_more_must_be_promised(adaptation: Adaptation, work: Work) -> None:
    propose(adaptation, work, 0.4, 0.7)
    work_for(adaptation, work, 3)
    assert adaptation.running == TABLE
    propose(adaptation, work, 3.0, 0.7)
    assert adaptation.wish is None
    assert "uncertainty" in adaptation.doubt


def test_a_load_taken_up_with_the_set_from_the_start_is_no_fault_of_the_next(
    adaptation: Adaptation, work: Work
) -> None:
    propose(adaptation, work, 1.6)
    work.arm = make_arm(tip={"mass": 0.2})
    work_for(adaptation, work, 1)
    for stretch in work.piece(adaptation.running)[: ADAPTATION_LIMITS.gain.lead_s + 1]:
        adaptation.take(stretch)
    assert adaptation.wish is None
    assert adaptation.activity == "trying a set"


def test_a_load_taken_up_is_no_fault_of_the_set_that_was_kept(adaptation: Adaptation, work: Work) -> None:
    propose(adaptation, work, 1.2)
    work_for(adaptation, work, 6)
    assert [one.outcome for one in adaptation.trials] == [Outcome.KEPT]
    work.arm = make_arm(tip={"mass": 0.3})
    for _ in range(3):
        for stretch in work.piece(adaptation.running):
            adaptation.take(stretch)
            asked = adaptation.task()
            if asked is not None:
                same = controllers_of(asked.table)
                adaptation.answer(proposal_of(asked, same, 1.0) if asked.budget else work_on(asked))
        assert adaptation.wish is None, "without fits it would be given up"


def test_a_fit_that_explains_nothing_excuses_no_set(adaptation: Adaptation, work: Work) -> None:
    """Such as one to stretches before and after a load was taken up."""
    propose(adaptation, work, 1.01)
    work_for(adaptation, work, 2)
    assert adaptation.on_trial
    known = adaptation.live
    weak = known.x + [np.log(3.0) if name.endswith("coulomb") else 0.0 for name in known.space.names]
    adaptation.answer(replace(known, x=weak, plants=known.space.plants(weak[None])))
    assert adaptation.live is known
    bad = TABLE.with_controllers(stiffer(0.4))
    for stretch in work.piece(bad):
        adaptation.take(stretch)
    assert [one.outcome for one in adaptation.trials] == [Outcome.WORSE]


def test_nothing_is_tried_while_a_reading_contradicts_its_voltages(adaptation: Adaptation, work: Work) -> None:
    work.arm = with_gain(1, 0.6)
    task = task_after_work(adaptation, work)
    found = work_on(replace(task, budget=0))
    assert isinstance(found, LiveModel)
    adaptation.answer(proposal_of(replace(task, live=found), stiffer(1.6)))
    assert adaptation.wish is None
    assert "joint 1's potentiometer turns 0.6 times as far" in adaptation.doubt


def test_one_fit_that_contradicts_the_readings_may_be_wrong(model: Model, work: Work) -> None:
    # It is taken, whatever it says of what was measured.
    adaptation = Adaptation(model, TABLE, budget=1, limits=deciding(max_log_misfit=100.0))
    propose(adaptation, work, 1.2)
    work_for(adaptation, work, 6)
    good = adaptation.live
    turned = [np.log(1.7) if name in ("joint2.inertia", "joint2.damping") else 0.0 for name in good.space.names]
    bad = replace(good, x=good.x + turned)
    for live in (bad, good, bad):
        adaptation.answer(live)
        assert adaptation.wish is None
    adaptation.answer(bad)
    assert adaptation.wish is not None
    assert adaptation.wish.table == adaptation.kept == TABLE


@pytest.mark.parametrize("pieces", [1, 6], ids=["on trial", "kept"])
def test_a_set_goes_back_when_a_reading_comes_to_contradict_its_voltages(
    adaptation: Adaptation, work: Work, pieces: int
) -> None:
    propose(adaptation, work, 1.2)
    work_for(adaptation, work, pieces)
    assert adaptation.running != TABLE
    work.arm = with_gain(3, 0.6)
    while adaptation.wish is None:
        assert work.time_s < 120.0
        for stretch in work.piece(adaptation.running):
            adaptation.take(stretch)
            asked = adaptation.task()
            if asked is not None and adaptation.wish is None:
                same = controllers_of(asked.table)
                adaptation.answer(proposal_of(asked, same, 1.0) if asked.budget else work_on(asked))
    assert adaptation.wish.table == adaptation.kept == TABLE
    (tried,) = adaptation.trials
    assert tried.outcome is Outcome.INCONCLUSIVE
    assert "joint 3's potentiometer turns 0.6 times as far" in tried.why


@pytest.mark.parametrize(("predicted", "spread"), [(0.97, 0.0), (0.6, 0.5)])
def test_what_is_not_better_by_more_than_its_uncertainty_is_not_tried(
    adaptation: Adaptation, work: Work, predicted: float, spread: float
) -> None:
    propose(adaptation, work, 3.0, predicted, spread)
    assert adaptation.wish is None
    assert "uncertainty" in adaptation.doubt


def test_a_joint_that_hunts_ends_a_trial_at_once(adaptation: Adaptation, work: Work) -> None:
    task = task_after_work(adaptation, work)
    adaptation.hunted(1)
    assert (adaptation.wish, adaptation.trials) == (None, []), "with the set from the start that changes nothing"
    adaptation.answer(proposal_of(task, stiffer(3.0)))
    work_for(adaptation, work, 1)
    adaptation.hunted(2)
    assert adaptation.wish is not None
    assert adaptation.wish.urgent
    assert adaptation.trials[0].outcome is Outcome.RESTLESS
    assert "joint 2" in adaptation.trials[0].why


def test_what_was_found_for_a_set_that_was_given_up_meanwhile_is_not_tried(adaptation: Adaptation, work: Work) -> None:
    propose(adaptation, work, 1.6)
    work_for(adaptation, work, 5)
    task = task_after_work(adaptation, work)
    adaptation.hunted(2)
    adaptation.answer(proposal_of(task, stiffer(2.0)))
    assert adaptation.wish is not None
    assert adaptation.wish.table == TABLE
    adaptation.changed()
    assert adaptation.task() is None
    assert [one.outcome for one in adaptation.trials] == [Outcome.RESTLESS]


def test_a_kept_set_that_follows_worse_later_gives_way_to_the_start(adaptation: Adaptation, work: Work) -> None:
    propose(adaptation, work, 1.6)
    work_for(adaptation, work, 5)
    assert [one.outcome for one in adaptation.trials] == [Outcome.KEPT]
    # As if the arm had become one on which this very set is bad.
    bad = TABLE.with_controllers(stiffer(0.4))
    while adaptation.wish is None:
        for stretch in work.piece(bad):
            adaptation.take(stretch)
        assert work.time_s < 100.0
    assert adaptation.wish.table == adaptation.kept == TABLE
    assert adaptation.wish.urgent
    assert [one.outcome for one in adaptation.trials] == [Outcome.WORSE]
    assert "after it had been kept" in adaptation.trials[0].why
