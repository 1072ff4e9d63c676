"""A GWO-WOA that does not know where the origin is: if a problem and its box are moved, the run moves with them.

Five things differ from the paper's:

- Q multiplies the leaders' and the wolves' positions relative to the pack's MEAN, not to the origin (Eqs. 9 to 11).
- A wolf goes to a new place only if it is better there. So the pack always holds the best places of its members.
- `a` (Eq. 6) stays the same. A pack that keeps only improvements shrinks by itself, at the speed that the problem
  allows, and needs no timetable that depends on the budget.
- Alpha counts more than beta, and beta more than delta (Eq. 15 with weights 0.5, 0.3, 0.2).
- A wolf keeps each coordinate with probability 0.2, and changes at least one.

Everything runs in units of the box, so scaling does not matter either. Bounds: a coordinate that would leave is put at
random between where it was and the bound, since wolves put onto a bound would pile up there.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from greywhale.base.types import Floats
from greywhale.optimise.box import latin_hypercube
from greywhale.optimise.grey_wolf import LEADERS, Draw, best_three, draw_alpha_factor, hunt
from greywhale.optimise.optimiser import Optimiser

# Chosen by trial on ten of the standard functions, shifted, with other seeds than those of any published figure. levy,
# schwefel226 and all rotated functions were kept aside. docs/optimise.md has the figures.
A_FACTOR = 3.5  # the `a` of Eq. 6
LEADER_WEIGHTS = (0.5, 0.3, 0.2)  # of alpha, beta, delta
KEEP_PROBABILITY = 0.2  # of a coordinate


class ShiftInvariantWolfWhale(Optimiser):
    """Translation- and scale-invariant GWO-WOA."""

    name: ClassVar[str] = "gwo-woa-relative"
    smallest_pack: ClassVar[int] = LEADERS
    _scatter = staticmethod(latin_hypercube)

    _costs: Floats
    _tried: Floats  # in unit coordinates, as the pack

    def _propose(self) -> Floats:
        if not len(self._pack):
            first = self._first_pack()
            self._tried = self.box.to_unit(first)
            return first
        wolves, dimensions = self._pack.shape
        leaders, _ = best_three(self._pack, self._costs)
        draw = Draw.of(self._source, wolves, dimensions)
        alpha = draw_alpha_factor(self._source, wolves)
        moved = hunt(
            self._pack, leaders, A_FACTOR, draw, alpha=alpha, origin=self._pack.mean(axis=0), weights=LEADER_WEIGHTS
        )
        self._tried = self._bring_back(self._keep_some(moved))
        return self.box.from_unit(self._tried)

    def _keep_some(self, moved: Floats) -> Floats:
        wolves, dimensions = moved.shape
        kept = self._source.random((wolves, dimensions)) < KEEP_PROBABILITY
        changes = np.floor(self._source.random((wolves,)) * dimensions).astype(int)
        kept[np.arange(wolves), changes] = False
        return np.where(kept, self._pack, moved)

    def _bring_back(self, moved: Floats) -> Floats:
        part = self._source.random(moved.shape)
        moved = np.where(moved < 0, self._pack * part, moved)
        return np.where(moved > 1, 1 - (1 - self._pack) * part, moved)

    def _learn(self, candidates: Floats, costs: Floats) -> None:
        if not len(self._pack):
            self._pack, self._costs = self._tried, costs
            return
        better = costs < self._costs
        self._pack = np.where(better[:, None], self._tried, self._pack)
        self._costs = np.where(better, costs, self._costs)
