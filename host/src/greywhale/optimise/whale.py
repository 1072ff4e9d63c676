"""The whale optimisation algorithm (Mirjalili and Lewis 2016).

By a coin's toss each whale swims a logarithmic spiral around the prey, or encircles it; while |A| >= 1 it encircles a
random whale instead. Bounds: a coordinate that leaves the box is put onto its bound.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.types import Floats
from greywhale.optimise.box import Box, Source
from greywhale.optimise.optimiser import PACK, Optimiser


def swim(pack: Floats, prey: Floats, others: Floats, a: float, r: Floats) -> Floats:
    """The whales' next places.

    `others` is the random whale of each. The rows of `r` are r1, r2, p and the spiral's number, each in [0, 1), a
    number a whale.
    """
    r1, r2, p, curl = (row[:, None] for row in r)
    big_a, c, curl = 2 * a * r1 - a, 2 * r2, 2 * curl - 1
    target = np.where(np.abs(big_a) < 1, prey, others)
    encircling = target - big_a * np.abs(c * target - pack)
    spiral = np.abs(prey - pack) * np.exp(curl) * np.cos(2 * np.pi * curl) + prey
    moved: Floats = np.where(p < 0.5, encircling, spiral)
    return moved


class Whale(Optimiser):
    """Plain WOA. Elitist, the default: the prey is the best point ever seen; otherwise the best of the present pack."""

    name: ClassVar[str] = "woa"

    def __init__(
        self,
        box: Box,
        budget: int,
        source: Source,
        *,
        pack: int = PACK,
        start: ArrayLike | None = None,
        elitist: bool = True,
    ) -> None:
        super().__init__(box, budget, source, pack=pack, start=start)
        self._elitist = elitist
        self._prey = np.zeros(box.dimensions)
        self._move = 0

    def _propose(self) -> Floats:
        if not len(self._pack):
            return self._first_pack()
        whales = len(self._pack)
        r = self._source.random((4, whales))
        others = self._pack[np.floor(self._source.random((whales,)) * whales).astype(int)]
        a = 2 * (1 - self._move / self._moves)
        self._move += 1
        return self.box.clip(swim(self._pack, self._prey, others, a, r))

    def _learn(self, candidates: Floats, costs: Floats) -> None:
        self._pack = candidates
        self._prey = self.best.x if self._elitist else candidates[int(np.argmin(costs))]
