"""The search on the model: the check's limits, steps and margins cost, and what is cheap there does well on the arm."""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.base.types import show_no_progress
from greywhale.commission.foresee import foresee
from greywhale.commission.journal import CommissioningJournal
from greywhale.commission.limits import COMMISSIONING_LIMITS
from greywhale.commission.measures import measure
from greywhale.commission.motions import PARTS, check_motion
from greywhale.commission.search import GAINS, CheckOnModel
from greywhale.commission.trials import Trials
from greywhale.files.arm import default_arm
from greywhale.loop.controllers import controllers_of
from greywhale.tune.judge.margins import with_gain
from greywhale.tune.model import load_model
from tests.commission.simulated import KD, KI, KP
from tests.support.limits import copy_of, reads_of
from tests.tune.models import write_model
from tools.support.simulated_rig import ROOM, SimulatedRig

pytestmark = pytest.mark.slow
ALL = np.ones(4, dtype=bool)


@pytest.fixture(scope="module")
def rig() -> SimulatedRig:
    return SimulatedRig(default_arm())


@pytest.fixture(scope="module")
def check(rig: SimulatedRig, tmp_path_factory: pytest.TempPathFactory) -> Iterator[CheckOnModel]:
    """With a model that is right."""
    folder = tmp_path_factory.mktemp("search")
    with CommissioningJournal(folder / "trials", {}, resume=False) as journal:
        trials = Trials(journal, check_motion(ROOM), rig.before)
        before = trials.play_before(lambda: rig)  # type: ignore[arg-type, return-value]
        foresight = foresee(default_arm(), trials.table, trials.check, before.traces, before.measured)
        model = load_model(write_model(folder / "model.toml"), samples=1, force=True)
        yield CheckOnModel.of(model, trials, foresight, seed=0, threads=1)


def varied(check: CheckOnModel, joint: int, factors: dict[int, float]) -> np.ndarray:
    rows = controllers_of(check.trials.table).copy()
    for place, factor in factors.items():
        rows[joint, place] = round(factor * rows[joint, place])
    return rows


def searching(check: CheckOnModel, **other: Any) -> CheckOnModel:
    """The same with some other limits of the search."""
    trials = copy(check.trials)
    trials.judging = replace(trials.judging, search=replace(trials.judging.search, **other))
    return replace(check, trials=trials)


def costs_beside(check: CheckOnModel, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The costs (4,) of the controllers from before, and of these."""
    before, after = check.costs(np.stack([controllers_of(check.trials.table), rows]))
    return before, after


def test_what_the_search_finds_follows_better_on_the_arm(check: CheckOnModel, rig: SimulatedRig) -> None:
    check = searching(check, packs=((0.1, 96),), retry_error=np.inf)
    trials = check.trials
    found = check.search(controllers_of(trials.table), ALL, 0, show_no_progress)
    trial = trials.play(lambda: rig, found)  # type: ignore[arg-type, return-value]
    assert trial.passed
    assert trial.score < 0.5


def test_a_stiffer_joint_that_rests_costs_less(check: CheckOnModel) -> None:
    rows = varied(check, 1, {KP: 1.4, KD: 1.2})
    before, after = costs_beside(check, rows)
    assert after[1] < before[1]


def test_a_joint_that_hunts_costs_more_and_its_neighbour_hardly(check: CheckOnModel) -> None:
    before, after = costs_beside(check, varied(check, 3, {KP: 20.0, KD: 0.1}))
    assert after[3] > 2.0 * before[3]
    assert after[0] < 1.5 * before[0]


def test_a_joint_that_follows_steps_worse_costs_more_where_the_model_knows_them(check: CheckOnModel) -> None:
    rows = varied(check, 1, {KP: 0.5})
    unknown = replace(check, foresight=replace(check.foresight, believed=np.zeros(4, dtype=bool)))
    assert costs_beside(check, rows)[1][1] > costs_beside(unknown, rows)[1][1] + 0.01


def test_a_joint_that_swings_between_steps_costs_more(check: CheckOnModel) -> None:
    rows = controllers_of(check.trials.table)
    calmer = replace(check, swings=np.full((2, 4), 1e-5))
    assert (calmer.costs(rows[None]) > check.costs(rows[None])).any()


def test_a_joint_that_hisses_costs_more(check: CheckOnModel) -> None:
    rows = controllers_of(check.trials.table)
    quieter = replace(check, aims=replace(check.aims, ripple=0.5 * check.aims.ripple))
    assert (quieter.costs(rows[None]) > check.costs(rows[None])).any()


def test_a_joint_that_overshoots_costs_more(check: CheckOnModel) -> None:
    rows = controllers_of(check.trials.table)
    strict = replace(check, overshoot=0.5 * check.overshoot)
    assert strict.costs(rows[None])[0, 0] > check.costs(rows[None])[0, 0] + 0.5


def test_a_joint_that_hunts_on_the_worse_arm_alone_costs_more(check: CheckOnModel) -> None:
    rows = varied(check, 1, {KP: 1.8, KD: 1.45})
    worse = replace(check.foresight, worse=with_gain(check.foresight.worse, 6.0))
    assert costs_beside(replace(check, foresight=worse), rows)[1][1] > costs_beside(check, rows)[1][1] + 0.1


class ShakenJoint(CheckOnModel):
    """A stiffer joint follows better, but joint 2 does not bear to be stiff beside a joint 0 that is much stiffer."""

    def costs(self, controllers: np.ndarray) -> np.ndarray:
        factors = controllers[:, :, KP] / controllers_of(self.trials.table)[:, KP]
        found: np.ndarray = 1.0 / factors
        found[:, 2] += 100.0 * ((factors[:, 0] > 1.5) & (factors[:, 2] > 1.2))
        return found


def test_what_the_search_finds_is_good_as_a_whole(check: CheckOnModel) -> None:
    shaken = ShakenJoint(**{one.name: getattr(check, one.name) for one in fields(check)})
    begin = controllers_of(check.trials.table)
    before, after = shaken.costs(np.stack([begin, shaken.search(begin, ALL, 0, show_no_progress)]))
    assert after.sum() < 0.9 * before.sum()
    assert after[2] < 100.0


def test_a_dead_end_of_the_tuning_is_left(check: CheckOnModel) -> None:
    """A joint that hardly moves: no narrow search around it finds one that follows."""
    check = searching(check, packs=((0.05, 32),))
    dead = varied(check, 1, {KP: 0.02, KD: 0.02, KI: 0.02})
    before, after = costs_beside(check, check.search(dead, ALL, 0, show_no_progress))
    assert after[1] < 1.5 * before[1] < 0.1 * costs_beside(check, dead)[1][1]


def test_what_the_arm_showed_beyond_the_model_the_model_may_show_less_of(check: CheckOnModel) -> None:
    """Joint 2 rattles by twice what is allowed, and three times what the model says; joint 1 ended the check."""
    before = check.trials.before
    said = next(check.arm.run(before.rows[None], check.foresight.plant))
    predicted = measure(said, check.trials.check, check.trials.table.supply_v).rattle[PARTS.index("reaches"), 2]
    rattle = before.measured.rattle.copy()
    rattle[PARTS.index("reaches"), 2] = 2.0 * check.limits.rattle[PARTS.index("reaches"), 2]
    ended = replace(before.verdicts[1], excess=np.inf)
    shown = replace(
        before,
        measured=replace(before.measured, rattle=rattle),
        verdicts=(before.verdicts[0], ended, *before.verdicts[2:]),
    )
    aims, least = check.corrected(shown).aims, 0.1 * check.aims.rattle[PARTS.index("reaches"), 2]
    assert aims.rattle[PARTS.index("reaches"), 2] == pytest.approx(max(0.85 / 2.0 * predicted, least))
    assert aims.rattle[:, 0] == pytest.approx(check.aims.rattle[:, 0]), "the model was right about the others"
    assert aims.unrest[:, 1] == pytest.approx(check.aims.unrest[:, 1]), "lower gains are for that, not lower aims"


def test_a_joint_that_hunted_gets_no_higher_gain_and_plants_that_hunt_as_it_did(
    check: CheckOnModel, rig: SimulatedRig
) -> None:
    check = searching(check, packs=((0.2, 8),), retry_error=np.inf)
    check.trials.done = list(check.trials.done)
    wild = varied(check, 2, {KP: 20.0, KI: 2.0})
    trial = check.trials.play(lambda: rig, wild)  # type: ignore[arg-type, return-value]
    assert trial.verdicts[2].hunts
    corrected = check.corrected(trial)
    assert corrected.failing is not None
    assert len(corrected.failing.plants) == 1
    dear, cheap = (costs_beside(one, wild)[1][2] for one in (corrected, check))
    assert dear > 1.2 * cheap
    begin = controllers_of(check.trials.table)
    found = replace(corrected, most=begin).search(begin, ALL, 0, show_no_progress)
    assert (found[:, GAINS] <= begin[:, GAINS]).all()
    assert corrected.most is not None
    assert (corrected.most[2] == wild[2]).all()


def test_a_joint_that_passed_keeps_its_controller(check: CheckOnModel) -> None:
    check = searching(check, packs=((0.1, 32),), retry_error=np.inf)
    begin = varied(check, 1, {KP: 0.5})
    found = check.search(begin, np.array([False, True, True, False]), 0, show_no_progress)
    assert (found != begin).any(axis=1).tolist() == [False, True, True, False]


def test_a_search_reads_no_limits_but_those_that_it_was_handed(rig: SimulatedRig, tmp_path: Path) -> None:
    """With the least of a search, and with what a trial showed."""
    own = copy_of(replace(COMMISSIONING_LIMITS, search=replace(COMMISSIONING_LIMITS.search, packs=((0.05, 4),))))
    with CommissioningJournal(tmp_path / "trials", {}, resume=False) as journal, reads_of(COMMISSIONING_LIMITS) as read:
        trials = Trials(journal, check_motion(ROOM, own.motion), rig.before, own)
        before = trials.play_before(lambda: rig)  # type: ignore[arg-type, return-value]
        foresight = foresee(default_arm(), trials.table, trials.check, before.traces, before.measured, own)
        model = load_model(write_model(tmp_path / "model.toml"), samples=1, force=True, judging=own.tuning)
        check = CheckOnModel.of(model, trials, foresight, seed=0, threads=1).corrected(before)
        check.search(controllers_of(trials.table), ALL, 0, show_no_progress)
    assert read == set()
