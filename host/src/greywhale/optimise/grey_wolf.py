"""The grey wolf optimiser, and the paper's hybrid of it with the whale optimisation algorithm (Eqs. 6 to 15, Fig. 5).

All wolves move at once. Random numbers are drawn in a fixed order, which `Draw` gives. Bounds: a coordinate that leaves
the box is put onto its bound, as in the code of both algorithms' authors. Both steps multiply a POSITION by a random
number (Q X_leader), so how far a wolf moves depends on where the origin of the coordinates lies. A pack far from the
origin jumps, one at the origin settles; relative.py has the remedy.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.elementary import cos, exp
from greywhale.base.types import Floats
from greywhale.optimise.box import Box, Source
from greywhale.optimise.optimiser import PACK, Optimiser

LEADERS = 3  # alpha, beta, delta
EQUAL_WEIGHTS = (1 / 3, 1 / 3, 1 / 3)  # of them, as in Eq. 15
# Eq. 6 falls from 2; the text lets it end at 0, the printed formula at 1.
A_START, A_END, A_END_AS_PRINTED = 2.0, 0.0, 1.0


@dataclass(frozen=True)
class Draw:
    """One move's random numbers in the order they are drawn: a leader, a wolf, a coordinate each; then a wolf each."""

    r1: Floats
    r2: Floats

    @classmethod
    def of(cls, source: Source, wolves: int, dimensions: int) -> Draw:
        return cls(source.random((LEADERS, wolves, dimensions)), source.random((LEADERS, wolves, dimensions)))


def alpha_factor(p: Floats, curl: Floats, gamma: Floats, rho: Floats, b: float = 1.0) -> Floats:
    """The factor of alpha's distance in Eq. 9, a wolf each: encircling below p = 0.5, else the whale's spiral."""
    spiral = rho * exp(b * curl) * cos(2 * np.pi * curl)
    return np.where(p < 0.5, gamma, spiral)


def hunt(
    pack: Floats,
    leaders: Floats,
    a: float,
    draw: Draw,
    *,
    alpha: Floats | None = None,
    origin: Floats | float = 0.0,
    weights: tuple[float, float, float] = EQUAL_WEIGHTS,
) -> Floats:
    """The wolves' next places (Eqs. 7, 8, 10 to 15). `alpha` is the factor of Eq. 9; without it this is plain GWO.

    `origin` is the point from which Q multiplies the leaders: the origin of the coordinates in the paper.
    """
    big_a = 2 * a * draw.r1 - a
    q = 2 * draw.r2
    distance = np.abs(q * (leaders[:, None] - origin) - (pack - origin))
    if alpha is not None:
        distance[0] *= alpha[:, None]
    towards = leaders[:, None] - big_a * distance
    # One after the other, since einsum fuses products and sums on some machines.
    moved: Floats = weights[0] * towards[0] + weights[1] * towards[1] + weights[2] * towards[2]
    return moved


def best_three(points: Floats, costs: Floats) -> tuple[Floats, Floats]:
    """Alpha, beta and delta with their costs; of equal ones the earlier leads."""
    order = np.argsort(costs, kind="stable")[:LEADERS]
    return points[order], costs[order]


class GreyWolf(Optimiser):
    """Plain GWO (Mirjalili et al. 2014).

    Elitist, the default: the leaders are the best three points ever seen. Otherwise they are the best three of the
    present pack, and good points can be lost.
    """

    name: ClassVar[str] = "gwo"
    smallest_pack: ClassVar[int] = LEADERS
    usual_a_end: ClassVar[float] = A_END

    def __init__(
        self,
        box: Box,
        budget: int,
        source: Source,
        *,
        pack: int = PACK,
        start: ArrayLike | None = None,
        a_end: float | None = None,
        elitist: bool = True,
    ) -> None:
        super().__init__(box, budget, source, pack=pack, start=start)
        self._a_end = self.usual_a_end if a_end is None else a_end
        self._elitist = elitist
        self._leaders = np.empty((0, box.dimensions))
        self._leader_costs = np.empty(0)
        self._move = 0

    @property
    def a(self) -> float:
        """The `a` of Eq. 6 at the coming move."""
        return A_START + (self._a_end - A_START) * self._move / self._moves

    def _propose(self) -> Floats:
        if not len(self._pack):
            return self._first_pack()
        draw = Draw.of(self._source, *self._pack.shape)
        moved = hunt(self._pack, self._leaders, self.a, draw, alpha=self._alpha())
        self._move += 1
        return self.box.clip(moved)

    def _alpha(self) -> Floats | None:
        return None

    def _learn(self, candidates: Floats, costs: Floats) -> None:
        self._pack = candidates
        if self._elitist:
            candidates = np.concatenate([self._leaders, candidates])
            costs = np.concatenate([self._leader_costs, costs])
        self._leaders, self._leader_costs = best_three(candidates, costs)


class GreyWolfWhale(GreyWolf):
    """The paper's GWO-WOA: by a coin's toss, each wolf encircles alpha or approaches it on the whale's spiral."""

    name: ClassVar[str] = "gwo-woa"

    def __init__(
        self,
        box: Box,
        budget: int,
        source: Source,
        *,
        pack: int = PACK,
        start: ArrayLike | None = None,
        a_end: float | None = None,
        elitist: bool = True,
        b: float = 1.0,
    ) -> None:
        super().__init__(box, budget, source, pack=pack, start=start, a_end=a_end, elitist=elitist)
        self._b = b

    def _alpha(self) -> Floats | None:
        return draw_alpha_factor(self._source, len(self._pack), self._b)


def draw_alpha_factor(source: Source, wolves: int, b: float = 1.0) -> Floats:
    """Draw p, l, gamma and rho, in this order, a number a wolf each."""
    p, curl, gamma, rho = (source.random((wolves,)) for _ in range(4))
    return alpha_factor(p, 2 * curl - 1, gamma, rho, b)


class GreyWolfWhaleAsPrinted(GreyWolfWhale):
    """GWO-WOA with Eq. 6 to the letter, a = 2 - t/T_max, which ends at 1: the wolves never come to rest."""

    name: ClassVar[str] = "gwo-woa-printed"
    usual_a_end: ClassVar[float] = A_END_AS_PRINTED
