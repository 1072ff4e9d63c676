"""Particle swarm optimisation with the global best and Clerc and Kennedy's constriction.

Bounds: a coordinate that leaves the box is put onto its bound and its velocity there becomes zero. The velocity is
limited to half the box a move.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from greywhale.base.types import Floats
from greywhale.optimise.optimiser import Optimiser

INERTIA_WEIGHT = 0.7298
ATTRACTION = 1.49618


def steer(
    velocity: Floats, places: Floats, own_best: Floats, best: Floats, limit: Floats, r1: Floats, r2: Floats
) -> Floats:
    """The particles' next velocities."""
    velocity = INERTIA_WEIGHT * velocity + ATTRACTION * (r1 * (own_best - places) + r2 * (best - places))
    return np.clip(velocity, -limit, limit)


class Swarm(Optimiser):
    """PSO; elitist by nature, since every particle remembers its best place."""

    name: ClassVar[str] = "pso"

    _velocity: Floats
    _own_best: Floats
    _own_costs: Floats

    def _propose(self) -> Floats:
        if not len(self._pack):
            return self._first_pack()
        r1, r2 = self._source.random(self._pack.shape), self._source.random(self._pack.shape)
        limit = 0.5 * self.box.width
        self._velocity = steer(self._velocity, self._pack, self._own_best, self.best.x, limit, r1, r2)
        moved = self._pack + self._velocity
        inside = self.box.clip(moved)
        self._velocity[inside != moved] = 0.0
        return inside

    def _learn(self, candidates: Floats, costs: Floats) -> None:
        if not len(self._pack):
            self._velocity, self._own_best, self._own_costs = np.zeros_like(candidates), candidates, costs
        better = costs < self._own_costs
        self._own_best = np.where(better[:, None], candidates, self._own_best)
        self._own_costs = np.where(better, costs, self._own_costs)
        self._pack = candidates


class RandomSearch(Optimiser):
    """Independent uniform points: every other method must beat them."""

    name: ClassVar[str] = "random"

    def _propose(self) -> Floats:
        if not self.evaluations:
            return self._first_pack()
        return self.box.from_unit(self._scatter(self._source, self.pack_size, self.box.dimensions))

    def _learn(self, candidates: Floats, costs: Floats) -> None:
        pass
