"""`ngopt` of `greywhale compare` asks what nevergrad asks when it is called directly, and leaves nothing behind."""

from __future__ import annotations

import threading

import nevergrad
import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.optimise import create, minimise
from greywhale_paper.optimisers.comparison import Plan
from greywhale_paper.optimisers.nevergrad_choice import NevergradChoice

LOWER, UPPER = np.array([-2.0, -1.0, 0.0, 3.0]), np.array([2.0, 4.0, 1.0, 9.0])


def valley(points: Floats) -> Floats:
    total: Floats = np.sum(100 * (points[:, 1:] - points[:, :-1] ** 2) ** 2 + (1 - points[:, :-1]) ** 2, axis=1)
    return total


def test_it_is_nevergrads_and_the_seed_decides() -> None:
    asked: list[Floats] = []

    def record(points: Floats) -> Floats:
        asked.append(points.copy())
        return valley(points)

    minimise(record, LOWER, UPPER, method=NevergradChoice, budget=120, seed=8)

    np.random.seed(123)  # nevergrad draws from numpy's global generator; nothing may depend on that
    source = np.random.default_rng(8)
    unit = nevergrad.p.Array(init=source.random(4), lower=0.0, upper=1.0)
    unit.random_state = np.random.RandomState(int(source.integers(2**32)))
    direct = nevergrad.optimizers.NGOpt(parametrization=unit, budget=120)
    for (point,) in asked:
        candidate = direct.ask()
        assert np.array_equal(point, LOWER + candidate.value * (UPPER - LOWER))
        direct.tell(candidate, float(valley(point[None])[0]))
    assert len(asked) == 120


def test_it_begins_at_the_start_point_and_bears_infinite_costs() -> None:
    start = 0.5 * (LOWER + UPPER)
    optimiser = create(NevergradChoice, LOWER, UPPER, budget=30, start=[start])
    assert np.allclose(optimiser.ask(), start)
    while not optimiser.done:
        optimiser.tell(np.full(len(optimiser.ask()), np.inf))


def test_its_threads_end_with_it() -> None:
    before = threading.active_count()
    minimise(valley, LOWER, UPPER, method=NevergradChoice, budget=100, callback=lambda step: step.evaluations == 20)
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and threading.active_count() > before:
            thread.join(timeout=60)
    assert threading.active_count() == before


@pytest.mark.parametrize(("more", "why"), [({"pack": 10}, "one point at a time"), ({"budget": 2000}, "fewer than 200")])
def test_a_comparison_refuses_what_it_cannot_do(more: dict[str, int], why: str) -> None:
    with pytest.raises(UserError, match=why):
        Plan(methods=("ngopt", "de"), **more).check()
