"""The adapters evaluate exactly what the libraries evaluate when they are called directly, and leave nothing behind."""

from __future__ import annotations

import gc
import threading

import cma
import numpy as np
import pytest
from scipy.optimize import differential_evolution

from greywhale.base.types import Floats
from greywhale.optimise import create, minimise

LOWER, UPPER = np.array([-2.0, -1.0, 0.0, 3.0]), np.array([2.0, 4.0, 1.0, 9.0])


def valley(points: Floats) -> Floats:
    total: Floats = np.sum(100 * (points[:, 1:] - points[:, :-1] ** 2) ** 2 + (1 - points[:, :-1]) ** 2, axis=1)
    return total


def test_differential_evolution_is_scipys() -> None:
    asked: list[Floats] = []

    def record(points: Floats) -> Floats:
        asked.append(points.copy())
        return valley(points)

    found = minimise(record, LOWER, UPPER, method="de", budget=300, seed=8)

    # The same generator, after it has placed the first pack.
    rng = np.random.default_rng(8)
    slices, offsets = np.argsort(rng.random((10, 4)), axis=0, kind="stable"), rng.random((10, 4))
    first = LOWER + (slices + offsets) / 10 * (UPPER - LOWER)
    direct: list[Floats] = []

    def scipys(columns: Floats) -> Floats:
        direct.append(columns.T.copy())
        return valley(columns.T)

    result = differential_evolution(
        scipys, list(zip(LOWER, UPPER, strict=True)), init=first, rng=rng, maxiter=29, tol=0.0, polish=False,
        updating="deferred", vectorized=True,
    )  # fmt: skip
    assert np.array_equal(np.concatenate(asked), np.concatenate(direct))
    assert found.cost == result.fun
    assert found.x.tolist() == result.x.tolist()
    assert len(np.concatenate(direct)) == 300


def test_differential_evolution_takes_scipys_options() -> None:
    costs = {
        strategy: minimise(valley, LOWER, UPPER, method="de", budget=300, seed=8, strategy=strategy).cost
        for strategy in ("best1bin", "rand1bin")
    }
    assert costs["best1bin"] != costs["rand1bin"]
    with pytest.raises(ValueError, match="mutation strategy"):
        minimise(valley, LOWER, UPPER, method="de", strategy="none such")


def threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "differential evolution"]


def test_scipys_thread_ends_when_the_search_is_stopped_or_the_cost_fails() -> None:
    minimise(valley, LOWER, UPPER, method="de", callback=lambda step: True)
    assert threads() == []
    with pytest.raises(ZeroDivisionError):
        minimise(lambda points: 1 / 0, LOWER, UPPER, method="de")
    assert threads() == []


@pytest.mark.parametrize("told", [0, 3])
@pytest.mark.parametrize("forget", [False, True])
def test_scipys_thread_ends_when_the_optimiser_is_closed_or_forgotten(told: int, forget: bool) -> None:
    optimiser = create("de", LOWER, UPPER, budget=1000)
    for _ in range(told):
        optimiser.tell(valley(optimiser.ask()))
    optimiser.ask()
    (thread,) = threads()
    if forget:
        del optimiser
        gc.collect()
        thread.join(timeout=60)
    else:
        optimiser.close()
        optimiser.close()
    assert not thread.is_alive()


def test_cma_es_is_cmas() -> None:
    asked: list[Floats] = []

    def record(points: Floats) -> Floats:
        asked.append(points.copy())
        return valley(points)

    minimise(record, LOWER, UPPER, method="cma-es", budget=240, seed=8)

    rng = np.random.default_rng(8)
    strategy = cma.CMAEvolutionStrategy(
        rng.random(4), 0.3, {
            "bounds": [0, 1], "seed": np.nan, "randn": lambda *shape: rng.standard_normal(shape), "verbose": -10,
            "verb_log": 0,
        },
    )  # fmt: skip
    for batch in asked:
        unit = strategy.ask()
        assert np.array_equal(batch, LOWER + np.array(unit) * (UPPER - LOWER))
        strategy.tell(unit, list(valley(batch)))
    assert len(asked) == 30
    assert not strategy.stop()


def test_cma_es_begins_anew_with_twice_the_pack_once_it_has_converged() -> None:
    sizes: list[int] = []

    def bowl(points: Floats) -> Floats:
        sizes.append(len(points))
        total: Floats = np.sum((points - 0.4) ** 2, axis=1)
        return total

    found = minimise(bowl, [0.0] * 2, [1.0] * 2, method="cma-es", budget=3000)
    assert sum(sizes) == 3000
    assert sizes == sorted(sizes[:-1]) + sizes[-1:]  # only the last batch, cut short, is smaller
    assert {6, 12} <= set(sizes)
    assert found.cost < 1e-12
