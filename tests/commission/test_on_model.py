"""The search on the model: the check's limits, steps and margins cost, and what is cheap there does well on the arm."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from greywhale.base.types import show_no_progress
from greywhale.commission import on_model
from greywhale.commission.foresee import foresee
from greywhale.commission.on_model import CheckOnModel
from greywhale.commission.search import KD, KI, KP
from greywhale.commission.trials import Trials
from greywhale.files.arm import default_arm
from greywhale.simulate.controllers import controllers_of
from greywhale.tune.judge.margins import with_gain
from greywhale.tune.model import load_model
from tests.commission.simulated import ROOM, SimulatedRig
from tests.tune.models import write_model

pytestmark = pytest.mark.slow


@pytest.fixture
def check(trials: Trials, rig: SimulatedRig, tmp_path: Path) -> CheckOnModel:
    """With a model that is right."""
    arm, before = default_arm(), trials.play_before(rig)  # type: ignore[arg-type]
    foresight = foresee(arm, trials.table, ROOM, trials.check, before.traces, before.measured)
    model = load_model(write_model(tmp_path / "model.toml"), samples=1, force=True)
    return CheckOnModel.of(model, trials, foresight, seed=0, threads=1)


def varied(check: CheckOnModel, joint: int, factors: dict[int, float]) -> np.ndarray:
    rows = controllers_of(check.trials.table).copy()
    for column, factor in factors.items():
        rows[joint, column] = round(factor * rows[joint, column])
    return rows


def costs_beside(check: CheckOnModel, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The costs (4,) of the controllers from before, and of these."""
    before, after = check.costs(np.stack([controllers_of(check.trials.table), rows]))
    return before, after


def test_what_the_search_finds_follows_better_on_the_arm(
    check: CheckOnModel, rig: SimulatedRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(on_model, "PACKS", ((0.1, 96),))
    monkeypatch.setattr(on_model, "POOR", np.inf)
    trials = check.trials
    found = check.search(controllers_of(trials.table), 0, show_no_progress)
    trial = trials.play(rig, found)  # type: ignore[arg-type]
    assert trial.passed
    assert trial.score < 0.5


def test_a_stiffer_joint_that_rests_costs_less_and_is_promised(check: CheckOnModel) -> None:
    rows = varied(check, 1, {KP: 1.8, KD: 1.45, KI: 1.8})
    before, after = costs_beside(check, rows)
    assert after[1] < before[1]
    start = controllers_of(check.trials.table)
    assert check.promises(start, 1, rows[1])
    assert not check.promises(rows, 1, start[1])


def test_a_joint_that_hunts_costs_more_and_its_neighbour_hardly(check: CheckOnModel) -> None:
    before, after = costs_beside(check, varied(check, 3, {KP: 20.0, KD: 0.1}))
    assert after[3] > 2.0 * before[3]
    assert after[0] < 1.5 * before[0]


def test_a_joint_that_follows_steps_worse_costs_more_where_the_model_knows_them(check: CheckOnModel) -> None:
    rows = varied(check, 1, {KP: 0.5})
    unknown = replace(check, foresight=replace(check.foresight, believed=np.zeros(4, dtype=bool)))
    assert costs_beside(check, rows)[1][1] > costs_beside(unknown, rows)[1][1] + 0.01


def test_a_joint_that_swings_between_steps_costs_more(check: CheckOnModel, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = controllers_of(check.trials.table)
    calmer = replace(check, foresight=replace(check.foresight, unrest=0.5 * check.foresight.unrest))
    monkeypatch.setattr(on_model, "STILL_RAD", 1e-6)
    assert (calmer.costs(rows[None]) > check.costs(rows[None])).any()


def test_a_joint_that_hisses_costs_more(check: CheckOnModel) -> None:
    rows = controllers_of(check.trials.table)
    quieter = replace(check, ripple=0.5 * check.ripple)
    assert (quieter.costs(rows[None]) > check.costs(rows[None])).any()


def test_a_joint_that_overshoots_costs_more(check: CheckOnModel) -> None:
    rows = controllers_of(check.trials.table)
    strict = replace(check, overshoot=0.5 * check.overshoot)
    assert strict.costs(rows[None])[0, 0] > check.costs(rows[None])[0, 0] + 0.5


def test_a_joint_that_hunts_on_the_worse_arm_alone_costs_more(check: CheckOnModel) -> None:
    rows = varied(check, 1, {KP: 1.8, KD: 1.45})
    worse = np.vstack([check.plants[:1], with_gain(check.plants[1:], 6.0)])
    assert costs_beside(replace(check, plants=worse), rows)[1][1] > costs_beside(check, rows)[1][1] + 0.1


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
    before, after = shaken.costs(np.stack([begin, shaken.search(begin, 0, show_no_progress)]))
    assert after.sum() < 0.9 * before.sum()
    assert after[2] < 100.0


def test_a_dead_end_of_the_tuning_is_left(check: CheckOnModel, monkeypatch: pytest.MonkeyPatch) -> None:
    """A joint that hardly moves: no narrow search around it finds one that follows."""
    monkeypatch.setattr(on_model, "PACKS", ((0.05, 32),))
    dead = varied(check, 1, {KP: 0.02, KD: 0.02, KI: 0.02})
    before, after = costs_beside(check, check.search(dead, 0, show_no_progress))
    assert after[1] < 1.5 * before[1] < 0.1 * costs_beside(check, dead)[1][1]
