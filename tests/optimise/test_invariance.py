"""Moving a problem and its box must move the run and nothing else; the paper's update cannot do that."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from greywhale.base.types import Floats
from greywhale.optimise import METHODS, minimise
from greywhale.optimise.functions import FUNCTIONS

LOWER, UPPER = np.full(5, -4.0), np.full(5, 4.0)
MINIMUM = np.array([0.5, -1.25, 2.0, 0.0, 3.0])
BOUND_TO_THE_ORIGIN = ("gwo", "gwo-woa", "gwo-woa-printed", "woa")


def run(method: str, name: str, shift: Floats, scale: Floats, seed: int = 3) -> Floats:
    """All points asked for, moved back to where they would be without the shift."""
    asked: list[Floats] = []

    def cost(points: Floats) -> Floats:
        back = (points - shift) / scale
        asked.append(back)
        return FUNCTIONS[name].cost(back - MINIMUM)

    low, high = LOWER * scale + shift, UPPER * scale + shift
    minimise(cost, low, high, method=method, budget=300, seed=seed)
    return np.concatenate(asked)


@pytest.mark.parametrize("method", [method for method in METHODS if method not in BOUND_TO_THE_ORIGIN])
@pytest.mark.parametrize("name", ["sphere", "rastrigin", "ackley"])
def test_moved_problem_moved_run(method: str, name: str) -> None:
    shift = np.array([1024.0, -64.0, 7.5, 0.0, -4.0])
    still = run(method, name, np.zeros(5), np.ones(5))
    assert run(method, name, shift, np.ones(5)) == pytest.approx(still, abs=1e-6)


@settings(max_examples=25, deadline=None)
@given(
    shift=st.lists(st.floats(-1e3, 1e3), min_size=5, max_size=5),
    scale=st.lists(st.floats(1e-2, 1e3), min_size=5, max_size=5),
    seed=st.integers(0, 10**6),
)
def test_default_cares_neither_where_the_box_is_nor_how_wide(shift: list[float], scale: list[float], seed: int) -> None:
    still = run("gwo-woa-relative", "sphere", np.zeros(5), np.ones(5), seed)
    assert run("gwo-woa-relative", "sphere", np.array(shift), np.array(scale), seed) == pytest.approx(still, abs=1e-6)


@pytest.mark.parametrize("method", BOUND_TO_THE_ORIGIN)
def test_the_papers_kind_runs_differently_when_moved(method: str) -> None:
    still = run(method, "sphere", np.zeros(5), np.ones(5))
    moved = run(method, "sphere", np.full(5, 16.0), np.ones(5))
    assert moved[:10] == pytest.approx(still[:10])  # the same first pack
    assert np.abs(moved[10:] - still[10:]).max() > 1.0
