"""What nevergrad would take, behind ask and tell: its NGOpt, which chooses a method by budget and dimensions.

It begins at a random point of the box (or at the start point) and asks for one point at a time. nevergrad is an extra:
`pip install 'greywhale-paper[peers]'`.
"""

from __future__ import annotations

import importlib
import warnings
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.types import Floats
from greywhale.optimise import Box, Optimiser

# nevergrad clips costs that are much higher, and warns.
WORST = 1e20
# From so many evaluations a coordinate on NGOpt fits metamodels, and those of nevergrad 1.0 fail with numpy 2.4.
METAMODELS_FROM = 200


class NevergradChoice(Optimiser):
    """`nevergrad.optimizers.NGOpt`, told that points are evaluated one after the other."""

    name: ClassVar[str] = "ngopt"

    def __init__(
        self,
        box: Box,
        budget: int,
        source: np.random.Generator,
        *,
        pack: int = 1,
        start: ArrayLike | None = None,
    ) -> None:
        if pack != 1:
            raise ValueError(f"the pack is {pack}, but ngopt asks for one point at a time; leave out one of them")
        if budget >= METAMODELS_FROM * box.dimensions:
            raise ValueError(
                f"the budget is {budget} evaluations, but ngopt takes fewer than {METAMODELS_FROM} for each of "
                f"{box.dimensions} coordinates; take fewer, or leave out ngopt"
            )
        super().__init__(box, budget, source, pack=pack, start=start)
        try:
            # Imported here: it takes two seconds, and is an extra. It imports Matplotlib, which is ours to do.
            importlib.import_module("greywhale.pictures.plotting")
            nevergrad: Any = importlib.import_module("nevergrad")
        except ImportError:
            raise ValueError("ngopt needs nevergrad; install it: pip install 'greywhale-paper[peers]'") from None
        # COBYLA, which NGOpt often takes, comments on nevergrad's options from a thread of its own.
        warnings.filterwarnings("ignore", "COBYLA: ", UserWarning)
        first = box.to_unit(self._start)[0] if len(self._start) else source.random(box.dimensions)
        unit = nevergrad.p.Array(init=first, lower=0.0, upper=1.0)
        unit.random_state = np.random.RandomState(int(source.integers(2**32)))
        self._strategy: Any = nevergrad.optimizers.NGOpt(parametrization=unit, budget=budget, num_workers=1)
        self._asked: Any = None

    def _propose(self) -> Floats:
        self._asked = self._strategy.ask()
        return self.box.from_unit(self._asked.value[None])

    def _learn(self, candidates: Floats, costs: Floats) -> None:
        self._strategy.tell(self._asked, min(float(costs[0]), WORST))

    def close(self) -> None:
        """Forget the strategy, whose threads end with it."""
        self._strategy = self._asked = None
