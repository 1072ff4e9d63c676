"""A whole tuning on a known arm: better and at rest, the same for any threads, whole after any interruption."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greywhale.arm.limits import GUESSES
from greywhale.arm.parameters import with_usual_noise
from greywhale.base.errors import UserError
from greywhale.base.types import show_no_progress
from greywhale.loop import plant_row
from greywhale.optimise import METHODS as OPTIMISERS
from greywhale.tune import METHODS, TuningResult, check_request, default, tune
from greywhale.tune.default import KU, DefaultMethod
from greywhale.tune.judge.margins import TEETH
from greywhale.tune.judge.standard import Standard
from greywhale.tune.limits import BY_THE_ARM, TUNING_LIMITS, WITHOUT_FLOORS
from greywhale.tune.model import Model, load_model
from greywhale.tune.request import TuningRequest
from greywhale.tune.search.lockstep import KEPT
from greywhale.tune.search.objective import Objective
from tests.support.arms import make_arm
from tests.support.interrupts import ctrl_c_at
from tests.support.limits import copy_of, reads_of
from tests.support.tuning import judge_nothing, shorten
from tests.tune.models import write_model

BUDGET = 60


@pytest.fixture(scope="module")
def model() -> Model:
    """The default arm as if it were identified, and a likely other one."""
    known = load_model("default", force=True)
    other = plant_row(known.arm) * np.where(np.arange(len(plant_row(known.arm))) == 12, 1.1, 1.0)
    return replace(known, plants=np.vstack([known.plants[0], other]))


@pytest.fixture(scope="module", autouse=True)
def _short_tunings() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        yield


@pytest.fixture(scope="module")
def sure(model: Model) -> Model:
    """The default arm, without another one that is likely."""
    return replace(model, plants=model.plants[:1])


@pytest.fixture
def unjudged(monkeypatch: pytest.MonkeyPatch) -> None:
    judge_nothing(monkeypatch)


def run(model: Model, **options: Any) -> TuningResult:
    given: dict[str, Any] = {"budget": BUDGET, "judging": WITHOUT_FLOORS}
    return tune(model, **given | options)


@pytest.fixture(scope="module")
def tuned(model: Model, tmp_path_factory: pytest.TempPathFactory) -> tuple[TuningResult, Path]:
    journal = tmp_path_factory.mktemp("tuning") / "journal"
    return run(model, journal=journal, threads=1), journal


def same(one: TuningResult, other: TuningResult) -> None:
    assert json.dumps(one.as_dict()) == json.dumps(other.as_dict())


@pytest.mark.slow
def test_a_short_search_already_follows_much_better(tuned: tuple[TuningResult, Path]) -> None:
    outcome, _ = tuned
    assert outcome.complete
    assert outcome.evaluations <= BUDGET
    assert all(after <= before for before, after in zip(outcome.cost_before, outcome.cost_after, strict=True))
    by_name = {one.name: one for one in outcome.held_out}
    assert by_name["steps"].mse_after.sum() < 0.92 * by_name["steps"].mse_before.sum()
    assert by_name["multi-steps"].mse_after.sum() < by_name["multi-steps"].mse_before.sum()
    # So few candidates may leave one joint on fine motions as it was.
    reaches = by_name["human-like reaches"]
    assert np.median(reaches.mse_after / reaches.mse_before) < 0.5


@pytest.mark.slow
def test_every_joint_comes_to_rest(tuned: tuple[TuningResult, Path]) -> None:
    outcome, _ = tuned
    assert len(outcome.margins) == len(outcome.margins_before) == 6 * 4
    for was, now in zip(outcome.margins_before, outcome.margins, strict=True):
        assert now.scenario == TEETH or now.plants_failing <= was.plants_failing
    assert all(margin.plants == 2 for margin in outcome.margins)


@pytest.mark.slow
def test_an_interrupted_tuning_goes_on_to_the_same_bytes_on_any_number_of_threads(
    model: Model, tuned: tuple[TuningResult, Path], tmp_path: Path
) -> None:
    outcome, journal = tuned
    path = tmp_path / "journal"
    first = run(model, journal=path, threads=2, report=ctrl_c_at("tuning", 0.4))
    assert not first.complete
    assert first.held_out == ()
    assert 0.4 * BUDGET < first.evaluations < 0.8 * BUDGET
    assert all(after <= before for before, after in zip(first.cost_before, first.cost_after, strict=True))
    assert journal.read_bytes().startswith(path.read_bytes())
    with path.open("ab") as file:
        file.write(b'{"stage":"sha')  # torn by the crash that came after the interrupt
    said = []
    second = run(model, journal=path, threads=2, resume=True, report=lambda what, *_, **__: said.append(what))
    same(second, outcome)
    assert path.read_bytes() == journal.read_bytes()
    assert list(dict.fromkeys(said)) == ["replaying the journal", "tuning", "judging"]


@pytest.mark.slow
def test_a_finished_journal_needs_no_simulation_and_an_interrupt_while_judging_keeps_its_best(
    model: Model, tuned: tuple[TuningResult, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(self: object, controllers: object) -> None:
        raise AssertionError("simulated although the journal knows")

    monkeypatch.setattr(DefaultMethod, "costs", never)
    outcome = run(model, journal=tuned[1], resume=True, report=ctrl_c_at("judging"))
    assert not outcome.complete
    assert outcome.curves == tuned[0].curves
    assert (outcome.after != outcome.before).any()
    assert "interrupted" in outcome.notes[0]


def test_an_interrupt_before_anything_was_tried_goes_on_up(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(self: object, controllers: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(DefaultMethod, "costs", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(model)


@pytest.mark.slow
def test_a_strategy_keeps_to_its_numbers_with_any_optimiser(sure: Model, unjudged: None) -> None:
    """Also where less voltage and less integral are tried, as no part of this strategy."""
    outcome = run(sure, strategy="mf", method="de", budget=25)
    np.testing.assert_array_equal(outcome.after[:, 8:12], outcome.before[:, 8:12])
    assert sum(outcome.cost_after) < sum(outcome.cost_before)
    assert 24 <= outcome.evaluations <= 25, "two turns share them"
    assert set(METHODS) == {"default", "paper", *OPTIMISERS}


@pytest.mark.slow
def test_a_budget_of_one_gives_the_start_back(sure: Model, unjudged: None) -> None:
    outcome = run(sure, budget=1)
    assert outcome.complete
    np.testing.assert_array_equal(outcome.after, outcome.before)


@pytest.mark.slow
def test_a_joint_whose_best_would_shake_its_gear_gets_less_voltage(
    sure: Model, unjudged: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last judgement refuses every candidate of the search, here by its Ku, but not one with less."""
    searched: list[int] = []

    def judge_costs(self: Any, controllers: np.ndarray, exact: bool = False) -> np.ndarray:
        costs = Objective.costs(self.judging, controllers)
        if not searched:
            searched.extend(self.found.contenders(KEPT)[:, 1, KU].tolist())
        refused = np.isin(controllers[:, 1, KU], searched)
        costs[refused, 1] += 10.0
        return np.asarray(costs)

    monkeypatch.setattr(DefaultMethod, "judge_costs", judge_costs)
    outcome = run(sure)
    assert outcome.after[1, KU] not in searched
    assert outcome.after[1, KU] in [round(share * searched[0]) for share, _ in TUNING_LIMITS.choice.gain_reductions]


def test_a_joint_whose_candidates_all_fall_short_is_searched_once_more(
    sure: Model, unjudged: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    known: set[bytes] = set()

    def judge_costs(self: Any, controllers: np.ndarray, exact: bool = False) -> np.ndarray:
        if not known:
            known.update(row.tobytes() for row in controllers[:, 1])
        changed = (controllers != self.start).any(axis=2)
        costs = np.where(changed, 0.5, 1.0)
        costs[changed[:, 1] & [row.tobytes() in known for row in controllers[:, 1]], 1] = 2.0
        return np.asarray(costs)

    monkeypatch.setattr(DefaultMethod, "judge_costs", judge_costs)
    monkeypatch.setattr(default, "AGAIN", replace(default.AGAIN, share=0.5))
    outcome = run(sure, budget=30)
    assert outcome.after[1].tobytes() not in known


@pytest.mark.slow
def test_the_benchs_own_arithmetic_has_the_last_word(
    sure: Model, unjudged: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every change of joint 1 looks better in single precision, and is worse in truth. With its controller from before
    the others' quicker moves shake it a little.
    """

    def judge_costs(self: Any, controllers: np.ndarray, exact: bool = False) -> np.ndarray:
        changed = (controllers != self.start).any(axis=2)
        costs = np.where(changed, 0.5, 1.0)
        if exact:
            costs[:, 1] = np.where(changed[:, 1], 2.0, np.where(changed.any(axis=1), 1.04, 1.0))
        return np.asarray(costs)

    monkeypatch.setattr(DefaultMethod, "judge_costs", judge_costs)
    outcome = run(sure, budget=30)
    np.testing.assert_array_equal(outcome.after[1], outcome.before[1])
    assert (outcome.after[[0, 2, 3]] != outcome.before[[0, 2, 3]]).any(axis=1).all()


def test_of_the_neighbours_of_a_kept_joint_only_the_one_that_disturbs_it_steps_back(
    sure: Model, unjudged: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def judge_costs(self: Any, controllers: np.ndarray, exact: bool = False) -> np.ndarray:
        changed = (controllers != self.start).any(axis=2)
        costs = np.where(changed, 0.5, 1.0)
        costs[:, 0] = 1.0 + changed[:, 0] + (0.2 if exact else 0.005) * changed[:, 2]
        return np.asarray(costs)

    monkeypatch.setattr(DefaultMethod, "judge_costs", judge_costs)
    outcome = run(sure, budget=30)
    changed = (outcome.after != outcome.before).any(axis=1)
    np.testing.assert_array_equal(changed, [False, True, False, True])


def test_where_the_arm_itself_will_judge_unrest_on_the_model_counts_less(
    sure: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(default, "penalty", lambda unrest, quiet_v, limits: np.ones((1, 4)))
    monkeypatch.setattr(Standard, "falls_short", lambda self, unrest, kept: np.ones((1, 4), dtype=bool))
    task = TuningRequest(sure, "both", "default", 1, 0, 1, sure.controllers, {}, show_no_progress)
    rows = sure.controllers[None]
    usual = DefaultMethod(task).judge_costs(rows)
    on_trial = DefaultMethod(replace(task, judging=BY_THE_ARM)).judge_costs(rows)
    limits = TUNING_LIMITS.choice
    assert usual - on_trial == pytest.approx(limits.unfit_cost + 1.0 - limits.unrest_weight_on_arm)


def test_silent_potentiometers_get_the_noise_of_ordinary_ones() -> None:
    arm = with_usual_noise(make_arm(follower_pots={"joint": {"noise": 0.0}}, leader_pots={"joint": {"noise": 0.01}}))
    assert [pot.noise for pot in arm.follower_pots.joint] == [GUESSES.noise_v] * 4
    assert [pot.noise for pot in arm.leader_pots.joint] == [0.01] * 4


@pytest.mark.parametrize(
    ("request_", "sentence"),
    [
        ({"strategy": "all"}, "there is no strategy 'all'"),
        ({"method": "magic"}, "'magic'; there are default, paper, gwo"),
        ({"budget": 0}, "budget is 0, but it must be at least 1"),
        ({"threads": -1}, "threads is -1"),
        ({"bounds": {"Ku": (5.0, 3.0)}}, "give the lower one first"),
        ({"method": "paper", "bounds": {"Ku": (3.0, 5.0)}}, "bounds of its own"),
    ],
)
def test_wrong_requests_are_bad_usage(request_: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence) as caught:
        check_request(**request_)
    assert caught.value.exit_code == 2


def test_a_ki_that_the_period_forbids_is_bad_usage(model: Model) -> None:
    slow = replace(model, table=model.table.with_raw({"period_ms": 20}))
    with pytest.raises(UserError, match="Ki reach to 500, .* 20 ms .* at most 204"):
        run(slow, bounds={"Ki": (1.0, 500.0)})


@pytest.mark.slow
def test_a_tuning_reads_no_limits_but_those_that_it_was_handed(tmp_path: Path) -> None:
    """From the model's checks to the held-out motions; it says what differs where it is a journal's."""
    own = copy_of(TUNING_LIMITS)
    path = write_model(tmp_path / "model.toml")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(TuningRequest, "facts", lambda request: {})
        with reads_of(TUNING_LIMITS) as read:
            model = load_model(path, samples=1, force=True, judging=own)
            tune(model, budget=12, threads=1, judging=own)
            tune(model, budget=12, threads=1, judging=replace(own, by_the_arm=True, floors=False))
    assert read == set()


def test_other_limits_are_another_tuning(sure: Model) -> None:
    task = TuningRequest(sure, "both", "default", 1, 0, 1, sure.controllers, {}, show_no_progress)
    assert "judging" not in replace(task, judging=BY_THE_ARM).facts()
    dearer = replace(TUNING_LIMITS, quiet=2.0, cost=replace(TUNING_LIMITS.cost, effort_weight=0.5))
    assert replace(task, judging=dearer).facts()["judging"] == {"cost.effort_weight": 0.5}
    assert replace(task, judging=dearer).facts()["quiet"] == 2.0


def test_what_voltage_costs_can_be_changed(sure: Model) -> None:
    """An ablation is a loop: no code is patched."""
    costs = []
    for weight in (0.0, 0.5):
        dearer = replace(TUNING_LIMITS, cost=replace(TUNING_LIMITS.cost, effort_weight=weight))
        task = TuningRequest(sure, "both", "default", 1, 0, 1, sure.controllers, {}, show_no_progress, dearer)
        costs.append(DefaultMethod(task).costs(sure.controllers[None])[0])
    assert (costs[1] > costs[0]).all()
