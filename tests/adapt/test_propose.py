"""What the background says of the sets that it compares; the search itself is tested where it stands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from greywhale.adapt import propose as propose_module
from greywhale.adapt.decide import Adaptation
from greywhale.adapt.limits import ADAPTATION_LIMITS
from greywhale.adapt.propose import Task, motion_of, propose
from greywhale.base.types import Controllers
from greywhale.files.arm import default_arm
from greywhale.files.trajectory import Trajectory
from greywhale.loop.controllers import controllers_of
from greywhale.protocol.firmware import TICK_S
from greywhale.tune.model import Model
from tests.adapt.conftest import TABLE
from tests.adapt.simulated import Work, work_for
from tests.adapt.test_decide import stiffer
from tests.support.arms import make_arm
from tests.support.limits import copy_of, reads_of

pytestmark = pytest.mark.slow
LIMITS = ADAPTATION_LIMITS.proposals


@dataclass
class Search:
    """In the place of a tuning: finds `after`, and keeps what it was asked."""

    after: Controllers
    asked: dict[str, Any]

    def __call__(self, model: Any, **asked: Any) -> Search:
        self.asked.update(asked, model=model)
        return self


@pytest.fixture(scope="module")
def task(model: Model) -> Task:
    adaptation = Adaptation(model, TABLE, budget=1)
    work_for(adaptation, Work(default_arm()), 4)
    found = adaptation.task()
    assert found is not None
    return found


def search(after: Controllers, monkeypatch: pytest.MonkeyPatch) -> Search:
    stand_in = Search(after, {})
    monkeypatch.setattr(propose_module, "tune", stand_in)
    return stand_in


def test_a_better_set_is_proposed_with_what_the_arm_will_show(
    task: Task, work: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    stand_in = search(stiffer(1.6), monkeypatch)
    proposal = propose(task)
    assert np.array_equal(proposal.rows, stiffer(1.6))
    assert proposal.scale.factor == pytest.approx([1.0] * 4, abs=0.25)
    errors = [
        np.mean([one.error for _ in range(3) for one in again.piece(TABLE.with_controllers(rows))], axis=0)
        for rows in (proposal.rows, task.start)
        for again in [Work(work.arm, seed=40)]
    ]
    assert proposal.predicted == pytest.approx(np.mean(errors[0] / errors[1]), abs=0.12)
    assert 0.0 <= proposal.spread < 0.2
    assert stand_in.asked["start"].tolist() == controllers_of(TABLE).tolist()
    assert len(stand_in.asked["model"].plants) == len(proposal.live.plants)


def test_the_set_that_runs_is_proposed_where_nothing_is_better(task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    search(stiffer(0.5), monkeypatch)
    proposal = propose(task)
    assert np.array_equal(proposal.rows, controllers_of(TABLE))
    assert proposal.predicted == 1.0


def test_the_set_from_the_start_competes(task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    search(controllers_of(TABLE), monkeypatch)
    proposal = propose(Task(**(vars(task) | {"start": stiffer(1.6)})))
    assert np.array_equal(proposal.rows, stiffer(1.6))


def test_what_was_seen_before_a_load_was_taken_up_is_left_out(
    adaptation: Adaptation, work: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    search(controllers_of(TABLE), monkeypatch)
    work_for(adaptation, work, 3)
    work.arm = make_arm(tip={"mass": 0.3})
    work_for(adaptation, work, 4)
    task = adaptation.task()
    assert task is not None
    proposal = propose(task)
    assert proposal.live.changes()["arm.tip"] == pytest.approx(0.3, abs=0.03)
    assert proposal.scale.factor == pytest.approx([1.0] * 4, abs=0.4)


def test_it_trains_on_the_longest_stretches_of_this_person_and_on_their_way_back_faster(task: Task) -> None:
    motion: Trajectory = motion_of(task.recent)
    assert motion.duration_s == pytest.approx(LIMITS.newest_s * (1.0 + 1.0 / LIMITS.faster), abs=0.02)
    there, back = np.split(motion.angles, [round(LIMITS.newest_s / TICK_S) // LIMITS.row_every_ticks])
    np.testing.assert_allclose(there[-1], task.recent[-1].leader[-LIMITS.row_every_ticks :].mean(axis=0))
    np.testing.assert_allclose(
        np.abs(np.diff(motion.angles, axis=0)).max(), LIMITS.faster * np.abs(np.diff(there, axis=0)).max(), rtol=0.1
    )
    np.testing.assert_allclose(back[1::2], there[-4::-3][: len(back[1::2])])


def test_a_session_reads_no_limits_but_those_that_it_was_handed(
    model: Model, work: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    search(stiffer(1.6), monkeypatch)
    own = copy_of(ADAPTATION_LIMITS)
    with reads_of(ADAPTATION_LIMITS) as read:
        adaptation = Adaptation(model, TABLE, budget=1, limits=own)
        work_for(adaptation, work, 4)
        found = adaptation.task()
        assert found is not None
        adaptation.answer(propose(found))
        work_for(adaptation, work, 3)
        assert adaptation.on_trial or adaptation.trials
    assert read == set()
