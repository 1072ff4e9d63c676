"""The methods by name, and one call that minimises with any of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.types import Floats
from greywhale.optimise.box import Box
from greywhale.optimise.cma_es import CmaEs
from greywhale.optimise.differential_evolution import DifferentialEvolution
from greywhale.optimise.grey_wolf import GreyWolf, GreyWolfWhale, GreyWolfWhaleAsPrinted
from greywhale.optimise.optimiser import History, Optimiser
from greywhale.optimise.shift_invariant import ShiftInvariantWolfWhale
from greywhale.optimise.swarm import RandomSearch, Swarm
from greywhale.optimise.whale import Whale

METHODS: dict[str, type[Optimiser]] = {
    method.name: method
    for method in (
        ShiftInvariantWolfWhale,
        GreyWolfWhale,
        GreyWolfWhaleAsPrinted,
        GreyWolf,
        Whale,
        Swarm,
        DifferentialEvolution,
        CmaEs,
        RandomSearch,
    )
}
# At 500 evaluations on shifted functions it is ahead of differential evolution; the figures are in docs/optimise.md.
DEFAULT = ShiftInvariantWolfWhale.name

Costs = Callable[[Floats], ArrayLike]


@dataclass(frozen=True)
class Step:
    """The progress of a minimisation, after a batch."""

    evaluations: int
    budget: int
    x: Floats
    cost: float


@dataclass(frozen=True)
class Minimum:
    """The best point found. `stopped` says why the search ended: the budget was spent, or the callback said so."""

    method: str
    x: Floats
    cost: float
    evaluations: int
    history: History
    stopped: Literal["budget", "callback"]


def create(
    method: str | type[Optimiser],
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    budget: int,
    seed: int | np.random.Generator = 0,
    pack: int | None = None,
    start: ArrayLike | None = None,
    **options: Any,
) -> Optimiser:
    """Make an optimiser to ask and tell: one of METHODS by its name, or of a class of your own.

    Without `pack` it has the method's own size. `start` are points (rows) that the first pack must hold; `options` are
    the method's.
    """
    if isinstance(method, str):
        if method not in METHODS:
            raise ValueError(f"there is no method {method!r}; there are {', '.join(METHODS)}")
        method = METHODS[method]
    if pack is not None:
        options["pack"] = pack
    return method(Box(lower, upper), budget, np.random.default_rng(seed), start=start, **options)


def minimise(
    cost: Costs,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    method: str | type[Optimiser] = DEFAULT,
    budget: int = 500,
    seed: int | np.random.Generator = 0,
    pack: int | None = None,
    start: ArrayLike | None = None,
    callback: Callable[[Step], bool | None] | None = None,
    **options: Any,
) -> Minimum:
    """Minimise a cost function of a whole batch (rows in, one cost for each row out); `mapped` makes one of a cost of a
    single point.

    Spends exactly `budget` evaluations, unless `callback`, called after every batch, returns True.
    """
    stopped: Literal["budget", "callback"] = "budget"
    with create(method, lower, upper, budget=budget, seed=seed, pack=pack, start=start, **options) as optimiser:
        while not optimiser.done:
            optimiser.tell(cost(optimiser.ask()))
            best = optimiser.best
            if callback is not None and callback(Step(optimiser.evaluations, budget, best.x.copy(), best.cost)):
                stopped = "callback"
                break
    return Minimum(optimiser.name, best.x, best.cost, optimiser.evaluations, optimiser.history, stopped)


def mapped(
    cost: Callable[[Floats], float], mapping: Callable[..., Iterable[float]] | None = None
) -> Callable[[Floats], Floats]:
    """The batch form of a cost function of one point, over anything like `map` (an executor's, a pool's)."""
    over = map if mapping is None else mapping

    def batch(points: Floats) -> Floats:
        return np.array(list(over(cost, list(points))), dtype=float)

    return batch
