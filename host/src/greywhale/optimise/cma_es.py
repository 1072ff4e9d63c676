"""CMA-ES (the package `cma`) behind ask and tell.

It works in units of the box, from a random point (or the first start point) with a standard deviation of 0.3. When it
has converged before the budget is spent, it restarts with twice the pack (IPOP). Bounds: cma's own transformation,
which maps the whole space into the box.
"""

from __future__ import annotations

import importlib
import math
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.types import Floats
from greywhale.optimise.box import Box
from greywhale.optimise.differential_evolution import WORST_COST
from greywhale.optimise.optimiser import Optimiser

START_SIGMA_SHARE = 0.3  # standard deviation of the first candidates, as a share of the box


class CmaEs(Optimiser):
    """`cma.CMAEvolutionStrategy` with its own defaults, the pack's size (4 + 3 ln d) included."""

    name: ClassVar[str] = "cma-es"
    smallest_pack: ClassVar[int] = 4

    def __init__(
        self,
        box: Box,
        budget: int,
        source: np.random.Generator,
        *,
        pack: int | None = None,
        start: ArrayLike | None = None,
        sigma: float = START_SIGMA_SHARE,
    ) -> None:
        if box.dimensions < 2:
            raise ValueError("cma-es needs at least two coordinates; take another method for one")
        default = 4 + int(3 * math.log(box.dimensions))
        super().__init__(box, budget, source, pack=default if pack is None else pack, start=start)
        self._generator = source
        self._sigma = sigma
        self._asked: list[Floats] = []
        self._strategy = self._begin(self.pack_size, self._start)

    def _begin(self, pack: int, start: Floats) -> Any:
        # Imported here: it takes two seconds, and most runs need no CMA-ES. It imports Matplotlib, which is ours to do.
        importlib.import_module("greywhale.pictures.plotting")
        cma: Any = importlib.import_module("cma")
        unit = self.box.to_unit(start)
        mean = unit[0] if len(unit) else self._generator.random(self.box.dimensions)
        strategy = cma.CMAEvolutionStrategy(
            mean,
            self._sigma,
            {
                "bounds": [0.0, 1.0],
                "popsize": pack,
                # numpy's global generator stays untouched, no file is read or written, nothing is printed.
                "seed": np.nan,
                "randn": lambda *shape: self._generator.standard_normal(shape),
                "verbose": -10,
                "verb_log": 0,
            },
        )
        if len(unit):
            strategy.inject(list(unit), force=True)
        return strategy

    def _propose(self) -> Floats:
        self._asked = self._strategy.ask()
        return self.box.from_unit(np.array(self._asked))

    def _learn(self, candidates: Floats, costs: Floats) -> None:
        self._strategy.tell(self._asked, list(np.where(np.isfinite(costs), costs, WORST_COST)))
        if self._strategy.stop():
            self._strategy = self._begin(2 * len(candidates), np.empty((0, self.box.dimensions)))
