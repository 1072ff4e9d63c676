"""The standard functions: values known by hand, minima where they are said to be, and where `place` puts them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from greywhale_paper.optimisers.functions import FUNCTIONS, SETTINGS, Setting, place

EVERY = pytest.mark.parametrize("name", list(FUNCTIONS))


@pytest.mark.parametrize(
    ("name", "point", "value"),
    [
        ("sphere", [3, 4], 25),
        ("elliptic", [2, 3], 4 + 9e6),
        ("schwefel12", [1, 2], 1 + 9),
        ("schwefel221", [-3, 2], 3),
        ("schwefel222", [-3, 2], 5 + 6),
        ("schwefel226", [0, 0], 2 * 418.9828872724338),
        ("schwefel226", [600, 0], 2 * 418.9828872724338 - 400 * math.sin(20) + 100**2 / 2e4),
        ("rosenbrock", [-1, 2], 100 + 4),
        ("zakharov", [1, 1], 2 + 1.5**2 + 1.5**4),
        ("rastrigin", [0.5, 1], 0.25 + 20 + 1),
        ("ackley", [1, 1], 20 - 20 * math.exp(-0.2)),
        ("griewank", [math.pi, 0], math.pi**2 / 4000 + 2),
        ("levy", [5, 1], 1 + 10 * math.sin(1) ** 2),
        ("levy", [1, 5], 1.0),
    ],
)
def test_values_by_hand(name: str, point: list[float], value: float) -> None:
    assert FUNCTIONS[name].cost(np.array([point], dtype=float)) == pytest.approx([value])


@EVERY
@pytest.mark.parametrize("setting", SETTINGS)
def test_minimum_is_zero_where_it_is_said_to_be_and_nowhere_less(name: str, setting: Setting) -> None:
    rng = np.random.default_rng(1)
    for dimensions in (2, 10):
        problem = place(FUNCTIONS[name], dimensions, setting, rng)
        assert problem(problem.minimum[None])[0] == pytest.approx(0.0, abs=1e-9)
        anywhere = rng.uniform(problem.lower, problem.upper, (5_000, dimensions))
        assert problem(anywhere).min() > 0.0
        width = problem.upper - problem.lower
        nearby = problem.minimum + rng.normal(size=(500, dimensions)) * width * 1e-3
        assert problem(nearby).min() > 0.0


@EVERY
def test_plain_is_as_published_and_shifted_is_anywhere_in_the_inner_part(name: str) -> None:
    function = FUNCTIONS[name]
    rng = np.random.default_rng(2)
    assert place(function, 4, "plain", rng).minimum.tolist() == [function.minimum_at] * 4
    places = np.array([place(function, 4, "shifted", rng).minimum for _ in range(500)]) / function.half_width
    assert np.abs(places).max() <= 0.8
    assert places.min() < -0.75
    assert places.max() > 0.75
    assert np.abs(places.mean(axis=0)).max() < 0.1


def test_rotation_turns_about_the_minimum_and_keeps_distances() -> None:
    problem = place(FUNCTIONS["elliptic"], 6, "rotated", np.random.default_rng(3))
    assert problem.rotation is not None
    assert problem.rotation @ problem.rotation.T == pytest.approx(np.eye(6), abs=1e-12)
    step = np.random.default_rng(4).normal(size=6)
    turned = FUNCTIONS["elliptic"].cost((problem.rotation @ step)[None])
    assert problem((problem.minimum + step)[None]) == pytest.approx(turned)
    sphere = place(FUNCTIONS["sphere"], 6, "rotated", np.random.default_rng(3))
    assert sphere((sphere.minimum + step)[None]) == pytest.approx([step @ step])
