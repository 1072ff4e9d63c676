"""Every method keeps these: exact budgets, bounds, repeatable and movable runs, batches as maps, failing costs."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from greywhale.base.types import Floats
from greywhale.optimise import METHODS, Step, create, mapped, minimise
from greywhale.optimise.swarm import Swarm
from greywhale_paper.optimisers.functions import FUNCTIONS
from tests.support.sentences import names

EVERY = pytest.mark.parametrize("method", list(METHODS))
LOWER, UPPER = np.array([-3.0, 0.5, -100.0]), np.array([2.0, 0.75, 40.0])
AT = np.array([1.0, 0.6, -20.0])


def bowl(points: Floats) -> Floats:
    total: Floats = np.sum(((points - AT) / (UPPER - LOWER)) ** 2, axis=1)
    return total


def bowl_of_one(point: Floats) -> float:
    return float(bowl(point[None])[0])


class Recorder:
    """A cost function that remembers what it was asked."""

    def __init__(self) -> None:
        self.batches: list[Floats] = []

    def __call__(self, points: Floats) -> Floats:
        self.batches.append(points.copy())
        return bowl(points)

    @property
    def points(self) -> Floats:
        return np.concatenate(self.batches)


@EVERY
@pytest.mark.parametrize("budget", [1, 10, 11, 253])
def test_budget_is_spent_to_the_evaluation(method: str, budget: int) -> None:
    cost = Recorder()
    found = minimise(cost, LOWER, UPPER, method=method, budget=budget)
    assert len(cost.points) == found.evaluations == found.history.evaluations[-1] == budget
    assert found.stopped == "budget"


@EVERY
def test_best_is_the_best_that_was_asked_and_the_history_never_rises(method: str) -> None:
    cost = Recorder()
    found = minimise(cost, LOWER, UPPER, method=method, budget=203, seed=3)
    costs = bowl(cost.points)
    assert found.cost == costs.min()
    assert found.x.tolist() == cost.points[np.argmin(costs)].tolist()
    assert found.history.evaluations == tuple(np.cumsum([len(batch) for batch in cost.batches]))
    assert found.history.cost == tuple(costs[:count].min() for count in found.history.evaluations)


@EVERY
def test_every_method_gets_far_better_than_its_first_pack(method: str) -> None:
    found = minimise(bowl, LOWER, UPPER, method=method, budget=1000, seed=3)
    # Two never come to rest off the origin, and one never learns.
    least = {"gwo-woa-printed": 20, "woa": 5, "random": 5}.get(method, 1000)
    assert found.cost < found.history.cost[0] / least
    assert found.method == method


@EVERY
@settings(max_examples=10, deadline=None)
@given(low=st.floats(-1e6, 1e6), width=st.floats(1e-6, 1e6), at=st.floats(-0.5, 1.5), seed=st.integers(0, 2**31))
def test_no_candidate_leaves_the_box(method: str, low: float, width: float, at: float, seed: int) -> None:
    high = low + width
    seen = Recorder()

    def cost(points: Floats) -> Floats:
        seen(np.hstack([points, points[:, :1]]))
        # Outside of the box for some `at`: then the way leads over the bound.
        total: Floats = np.sum(np.abs(points - (low + at * width)), axis=1)
        return total

    minimise(cost, [low] * 2, [high] * 2, method=method, budget=120, seed=seed)
    assert ((seen.points >= low) & (seen.points <= high)).all()


@EVERY
def test_same_seed_same_run_and_another_seed_another(method: str) -> None:
    runs = []
    for seed in (4, 4, 5):
        cost = Recorder()
        minimise(cost, LOWER, UPPER, method=method, budget=100, seed=seed)
        runs.append(cost.points)
    assert (runs[0] == runs[1]).all()
    assert not (runs[0][:4] == runs[2][:4]).any()


@EVERY
def test_batch_and_map_and_threads_give_the_same_run(method: str) -> None:
    whole = minimise(bowl, LOWER, UPPER, method=method, budget=155, seed=2)
    with ThreadPoolExecutor(2) as pool:
        for mapping in (None, map, pool.map):
            one_by_one = minimise(mapped(bowl_of_one, mapping), LOWER, UPPER, method=method, budget=155, seed=2)
            assert one_by_one.history == whole.history
            assert one_by_one.x.tolist() == whole.x.tolist()


@EVERY
def test_callback_sees_every_batch_and_ends_the_search(method: str) -> None:
    steps: list[Step] = []

    def enough(step: Step) -> bool:
        steps.append(step)
        return step.evaluations >= 40

    found = minimise(bowl, LOWER, UPPER, method=method, budget=500, callback=enough)
    assert found.stopped == "callback"
    assert 40 <= found.evaluations < 60
    assert tuple(step.evaluations for step in steps) == found.history.evaluations
    assert tuple(step.cost for step in steps) == found.history.cost
    assert {step.budget for step in steps} == {500}
    assert steps[-1].x.tolist() == found.x.tolist()


@EVERY
@pytest.mark.parametrize("bad", [np.nan, -np.inf])
def test_failed_costs_are_worst_and_stop_nothing(method: str, bad: float) -> None:
    def half_failing(points: Floats) -> Floats:
        return np.where(points[:, 0] < 0.0, bad, bowl(points))

    found = minimise(half_failing, LOWER, UPPER, method=method, budget=400, seed=1)
    assert found.evaluations == 400
    assert found.x[0] >= 0.0
    assert found.cost < 0.05


@EVERY
def test_start_points_are_in_the_first_pack(method: str) -> None:
    start = np.array([AT, [1.5, 0.7, 30.0]])
    cost = Recorder()
    found = minimise(cost, LOWER, UPPER, method=method, budget=60, start=start)
    for point in start:
        assert np.isclose(cost.batches[0], point, rtol=1e-12, atol=1e-12).all(axis=1).any()
    assert found.cost <= bowl_of_one(AT) + 1e-12


@EVERY
def test_ask_repeats_itself_until_told_and_gives_away_nothing_of_its_own(method: str) -> None:
    with create(method, LOWER, UPPER, budget=100, seed=1) as optimiser:
        with pytest.raises(ValueError, match="nothing has been evaluated"):
            _ = optimiser.best
        with pytest.raises(ValueError, match="without ask"):
            optimiser.tell([1.0])
        first = optimiser.ask()
        kept = first.copy()
        first[:] = 0.0
        assert (optimiser.ask() == kept).all()
        with pytest.raises(ValueError, match="need one cost each"):
            optimiser.tell(np.zeros(len(kept) + 1))
        optimiser.tell(bowl(kept))
        assert not (optimiser.ask() == kept).all()
        assert optimiser.evaluations == len(kept)
        assert optimiser.remaining == 100 - len(kept)


def test_spent_budget_gives_no_more_candidates() -> None:
    optimiser = create("pso", [0], [1], budget=4)
    optimiser.ask()
    optimiser.tell(np.zeros(4))
    assert optimiser.done
    with pytest.raises(ValueError, match="budget of 4 evaluations is spent"):
        optimiser.ask()


@pytest.mark.parametrize("method", [method for method in METHODS if method != "cma-es"])
def test_one_coordinate_is_enough(method: str) -> None:
    assert minimise(lambda x: (x[:, 0] - 0.3) ** 2, [0], [1], method=method, budget=400).cost < 1e-3


def test_a_class_of_ones_own_is_taken_where_a_name_is() -> None:
    class Mine(Swarm):
        name = "mine"

    named, mine = (minimise(bowl, LOWER, UPPER, method=method, budget=60, seed=3) for method in ("pso", Mine))
    assert (named.method, mine.method) == ("pso", "mine")
    assert (named.x == mine.x).all()
    assert "mine" not in METHODS


@pytest.mark.parametrize(
    ("arguments", "things"),
    [
        ({"method": "simplex"}, "no method simplex gwo-woa-relative"),
        ({"budget": 0}, "budget 0"),
        ({"pack": 2}, "pack 2 gwo-woa 3"),
        ({"start": [[0, 0.6, 0], [0, 0.8, 0]]}, "coordinate 1 point 1 0.8 [0.5, 0.75]"),
        ({"start": [[0, np.nan, 0]]}, "coordinate 1 point 0 nan"),
        ({"start": [[0, 0.6]]}, "3 coordinates"),
        ({"start": [AT] * 11}, "11 points 10"),
        ({"lower": [0, 0]}, "(2,) (3,)"),
        ({"lower": [-3, 0.75, -100]}, "coordinate 1 0.75 0.75"),
        ({"lower": [-3, 0.5, -np.inf]}, "coordinate 2 -inf 40"),
        ({"method": "cma-es", "lower": [0], "upper": [1]}, "cma-es two coordinates"),
    ],
)
def test_wrong_use_is_refused_by_thing_and_value(arguments: dict[str, object], things: str) -> None:
    given: dict[str, object] = {"method": "gwo-woa", "lower": LOWER, "upper": UPPER, "budget": 50, **arguments}
    with pytest.raises(ValueError, match=".") as refused:
        create(**given)  # type: ignore[arg-type]
    assert names(str(refused.value), things)


LOW, HIGH = np.full(5, -4.0), np.full(5, 4.0)
MINIMUM = np.array([0.5, -1.25, 2.0, 0.0, 3.0])
BOUND_TO_THE_ORIGIN = ("gwo", "gwo-woa", "gwo-woa-printed", "woa")


def run_moved(method: str, shift: Floats) -> Floats:
    """All points asked for, moved back to where they would be without the shift."""
    asked: list[Floats] = []

    def cost(points: Floats) -> Floats:
        asked.append(points - shift)
        return FUNCTIONS["ackley"].cost(asked[-1] - MINIMUM)

    minimise(cost, LOW + shift, HIGH + shift, method=method, budget=300, seed=3)
    return np.concatenate(asked)


@pytest.mark.parametrize("method", list(METHODS))
def test_only_the_papers_kind_runs_differently_when_the_problem_is_moved(method: str) -> None:
    still, moved = (run_moved(method, shift) for shift in (np.zeros(5), np.array([1024.0, -64.0, 7.5, 0.0, -4.0])))
    if method not in BOUND_TO_THE_ORIGIN:
        assert moved == pytest.approx(still, abs=1e-6)
        return
    assert moved[:10] == pytest.approx(still[:10])  # the same first pack
    assert np.abs(moved[10:] - still[10:]).max() > 1.0
