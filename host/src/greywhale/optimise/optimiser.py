"""The base of every optimiser: ask for candidates, tell their costs, until the budget of evaluations is spent.

It keeps the books (budget, best point, convergence history, non-finite costs), so a method only has to say where to
look next and what it learns. It never calls the cost function itself: the caller may evaluate a batch natively, over
processes, or on a bench.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.closing import Closing
from greywhale.base.types import Floats
from greywhale.optimise.box import Box, Source, scatter

PACK = 10  # candidates in a batch, as in the paper


@dataclass(frozen=True)
class Best:
    """The best point so far; its cost is infinite while no candidate had a finite one."""

    x: Floats
    cost: float


@dataclass(frozen=True)
class History:
    """The best cost after each batch: `cost[k]` was the best of the first `evaluations[k]` evaluations."""

    evaluations: tuple[int, ...]
    cost: tuple[float, ...]


class Optimiser(Closing):
    """Minimises within a box. `ask()` returns the candidates as rows, `tell(costs)` takes one cost a row.

    A batch never exceeds the rest of the budget: the last one is cut short. NaN and infinities (of either sign) are the
    worst costs: no candidate loses against them.
    """

    name: ClassVar[str]
    smallest_pack: ClassVar[int] = 1
    _scatter = staticmethod(scatter)  # of the first pack

    def __init__(
        self, box: Box, budget: int, source: Source, *, pack: int = PACK, start: ArrayLike | None = None
    ) -> None:
        if budget < 1:
            raise ValueError(f"the budget is {budget} evaluations; it must be at least 1")
        if pack < self.smallest_pack:
            raise ValueError(f"the pack is {pack}, but {self.name} needs at least {self.smallest_pack}")
        self.box = box
        self.budget = budget
        self.pack_size = pack
        self._source = source
        self._start = np.empty((0, box.dimensions)) if start is None else box.check_inside(start)
        if len(self._start) > pack:
            raise ValueError(f"{len(self._start)} start points do not fit into a pack of {pack}")
        self._pack = np.empty((0, box.dimensions))  # of methods that move one
        self._pending: Floats | None = None
        self._cut_short = False
        self._evaluations = 0
        self._best: Best | None = None
        self._history: list[tuple[int, float]] = []

    # The parts that a method defines.

    @abstractmethod
    def _propose(self) -> Floats:
        """The next whole batch of candidates, inside the box."""

    @abstractmethod
    def _learn(self, candidates: Floats, costs: Floats) -> None:
        """Take in the costs of the last whole batch; +inf stands for every non-finite cost."""

    def close(self) -> None:
        """Free what the method holds besides memory."""

    # The interface for a caller.

    def ask(self) -> Floats:
        """The candidates to evaluate next; again these until `tell` has their costs."""
        if self._pending is None:
            if self.done:
                raise ValueError(f"the budget of {self.budget} evaluations is spent")
            whole = self._propose()
            self._pending = whole[: self.remaining]
            self._cut_short = len(whole) > self.remaining
        return self._pending.copy()

    def tell(self, costs: ArrayLike) -> None:
        """The costs of the candidates that `ask` gave, in their order."""
        if self._pending is None:
            raise ValueError("tell() without ask(): there are no candidates these costs could belong to")
        values = np.array(costs, dtype=float)
        if values.shape != (len(self._pending),):
            raise ValueError(
                f"{len(self._pending)} candidates need one cost each, but the costs' shape is {values.shape}"
            )
        values[~np.isfinite(values)] = np.inf
        candidates, self._pending = self._pending, None
        self._evaluations += len(candidates)
        self._remember(candidates, values)
        if not self._cut_short:
            self._learn(candidates, values)
        if self.done:
            self.close()

    @property
    def evaluations(self) -> int:
        return self._evaluations

    @property
    def remaining(self) -> int:
        return self.budget - self._evaluations

    @property
    def done(self) -> bool:
        return self.remaining <= 0

    @property
    def best(self) -> Best:
        if self._best is None:
            raise ValueError("nothing has been evaluated yet")
        return self._best

    @property
    def history(self) -> History:
        return History(tuple(at for at, _ in self._history), tuple(cost for _, cost in self._history))

    # The parts that methods share.

    @property
    def _moves(self) -> int:
        """The number of batches that follow the first: the paper's T_max."""
        return max(1, -(-self.budget // self.pack_size) - 1)

    def _first_pack(self) -> Floats:
        """The start points, then points all over the box."""
        pack = self.box.from_unit(self._scatter(self._source, self.pack_size, self.box.dimensions))
        pack[: len(self._start)] = self._start
        return pack

    def _remember(self, candidates: Floats, costs: Floats) -> None:
        index = int(np.argmin(costs))
        if self._best is None or costs[index] < self._best.cost:
            self._best = Best(candidates[index].copy(), float(costs[index]))
        self._history.append((self._evaluations, self._best.cost))
