"""Four searches in lockstep, on costs that can be worked out by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greywhale.loop import default_controller
from greywhale.optimise import Optimiser, create
from greywhale.tune.search import lockstep as search
from greywhale.tune.search.lockstep import KEPT, TOGETHER, TURNS, LockstepSearch, SearchState
from greywhale.tune.search.space import CE_TICKS, Space

BEFORE = default_controller()
SPACE = Space.default("both", BEFORE, 15_000, 1)
# Where each joint's hill is lowest, in shares of the box.
AIMS = np.array([0.2, 0.4, 0.6, 0.8])


class Hills:
    """A cost a joint: its distance from its aim; `rows` holds all that was evaluated."""

    def __init__(self) -> None:
        self.rows: list[np.ndarray] = []

    def __call__(self, rows: np.ndarray) -> np.ndarray:
        self.rows.append(rows.copy())
        share = (SPACE.points(rows) - SPACE.lower) / (SPACE.upper - SPACE.lower)
        return np.asarray(((share - AIMS[:, None]) ** 2).sum(axis=2))


def lockstep(search: LockstepSearch, method: str, budget: int, **options: Any) -> None:
    search.run(SPACE, stage="test", method=method, budget=budget, seed=(1,), start=BEFORE, **options)


def run(method: str = "gwo-woa-relative", budget: int = 400, groups: object = TOGETHER) -> tuple[SearchState, Hills]:
    found, hills = SearchState.nothing(BEFORE), Hills()
    search = LockstepSearch(hills, found)
    search.try_again("start")
    lockstep(search, method, budget, groups=groups)
    return found, hills


@pytest.mark.parametrize("groups", [TOGETHER, TURNS])
def test_every_joint_finds_its_own_aim(groups: object) -> None:
    found, hills = run(budget=600, groups=groups)
    assert (found.cost < 0.1 * hills(BEFORE[None])[0]).all()
    np.testing.assert_allclose(hills(found.best[None])[0], found.cost)


@pytest.mark.parametrize("method", ["de", "gwo-woa"])
def test_the_budget_is_spent_exactly_by_every_joint(method: str) -> None:
    found, hills = run(method, budget=57)
    assert found.evaluations == 58, "the start and 57 more"
    assert sum(len(rows) for rows in hills.rows) == 58


def test_turns_leave_the_others_at_their_best() -> None:
    _, hills = run(budget=40, groups=TURNS)
    for rows in hills.rows[1:]:
        still = [joint for joint in range(4) if len(np.unique(rows[:, joint], axis=0)) == 1]
        assert still in ([0, 2], [1, 3])


def test_joints_of_no_group_keep_what_they_have() -> None:
    found, _ = run(budget=20, groups=((1, 3),))
    assert (found.best != BEFORE).any(axis=1).tolist() == [False, True, False, True]
    assert found.evaluations == 21


@pytest.mark.parametrize("method", ["gwo-woa-relative", "cma-es"])
def test_a_narrow_stage_begins_around_its_start(method: str) -> None:
    hills = Hills()
    lockstep(LockstepSearch(hills, SearchState.nothing(BEFORE)), method, 8, sigma=0.02)
    tried = SPACE.points(np.concatenate(hills.rows))
    away = np.abs(tried - SPACE.points(BEFORE[None])) / (SPACE.upper - SPACE.lower)
    assert (away < 0.1).all()
    moved = away.max(axis=0) > 0.0
    assert moved[:, [name != CE_TICKS for name in SPACE.names]].all()  # the next number of ticks is far away


def test_trying_again_forgets_what_neighbours_that_are_gone_made_of_a_cost() -> None:
    found, hills = run(budget=57)
    best = found.best.copy()
    LockstepSearch(lambda rows: hills(rows) + 1.0, found).try_again("again")
    np.testing.assert_array_equal(found.best, best)
    np.testing.assert_allclose(found.cost, hills(best[None])[0] + 1.0)
    assert found.evaluations == 59
    assert (found.contenders(KEPT) == best).all(), "candidates of other neighbours do not compete any more"


def test_contenders_are_the_best_different_ones_in_order() -> None:
    found, hills = run(budget=200)
    costs = hills(found.contenders(KEPT))
    assert (np.diff(costs, axis=0) >= 0.0).all()
    for joint in range(4):
        assert len(np.unique(found.contenders(KEPT)[:, joint], axis=0)) == KEPT
    np.testing.assert_array_equal(found.contenders(1)[0], found.best)


def test_optimisers_are_given_back_when_a_search_is_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    closed: list[Optimiser] = []

    def watched(*args: Any, **options: Any) -> Optimiser:
        made = create(*args, **options)
        monkeypatch.setattr(made, "close", lambda: closed.append(made))
        return made

    def interrupted(_: np.ndarray) -> np.ndarray:
        raise KeyboardInterrupt

    monkeypatch.setattr(search, "create", watched)
    with pytest.raises(KeyboardInterrupt):
        lockstep(LockstepSearch(interrupted, SearchState.nothing(BEFORE)), "gwo-woa", 10)
    assert len(closed) == 4
