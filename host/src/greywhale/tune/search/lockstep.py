"""Four optimisers in lockstep: candidate i of every joint is tried together with candidate i of the others.

So one simulation of the arm serves four searches, and every joint is judged among moving neighbours. Each joint is told
its own cost. A method's batches may grow at different times (CMA-ES restarts with a larger pack). A joint with fewer
candidates then runs its best one in the rows that are left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from greywhale.base.types import Controllers, Floats
from greywhale.optimise import Optimiser, create
from greywhale.optimise.box import latin_hypercube
from greywhale.optimise.cma_es import START_SIGMA_SHARE, CmaEs
from greywhale.optimise.optimiser import PACK
from greywhale.protocol.firmware import JOINTS
from greywhale.tune.search.journal import TuningJournal
from greywhale.tune.search.space import Space

Costs = Callable[[Controllers], Floats]
Tick = Callable[["SearchState"], None]

# Which joints' candidates are tried at the same time.
TOGETHER = (range(JOINTS),)
TURNS = ((0, 2), (1, 3))


@dataclass
class SearchState:
    """The best so far of every joint, and the course of the search."""

    best: Controllers  # (4, 13)
    cost: Floats  # (4,); infinite while a joint has none
    evaluations: int = 0
    narrowed: int = 0  # numbers whose width was below 0.01 and became 0.01
    curve: list[tuple[int, tuple[float, ...]]] = field(default_factory=list)
    ranking: list[list[tuple[float, bytes]]] = field(default_factory=lambda: [[] for _ in range(JOINTS)])

    @classmethod
    def nothing(cls, start: Controllers) -> SearchState:
        return cls(start.copy(), np.full(JOINTS, np.inf))

    @property
    def total(self) -> float:
        return float(self.cost.sum())

    def take(self, rows: Controllers, costs: Floats, counts: list[int]) -> None:
        """Take in candidates (n, 4, 13) with their costs (n, 4); of joint j the first counts[j] rows are new."""
        self.evaluations += len(rows)
        for joint, count in enumerate(counts):
            self.ranking[joint] += [(float(costs[row, joint]), rows[row, joint].tobytes()) for row in range(count)]
            self.ranking[joint] = _best_few(self.ranking[joint])
            if count and costs[:count, joint].min() < self.cost[joint]:
                row = int(np.argmin(costs[:count, joint]))
                self.best[joint], self.cost[joint] = rows[row, joint], costs[row, joint]
        self.curve.append((self.evaluations, tuple(float(cost) for cost in self.cost)))

    def forget_costs(self) -> None:
        """Keep the best of every joint, but not what it or any other candidate cost."""
        self.cost = np.full(JOINTS, np.inf)
        self.ranking = [[] for _ in range(JOINTS)]

    def contenders(self, count: int) -> Controllers:
        """(count, 4, 13): every joint's best, then others from further down its list; the first few are alike."""
        rows = np.repeat(self.best[None], count, axis=0)
        for joint, ranked in enumerate(self.ranking):
            for place, rank in enumerate(RANKS[:count]):
                if ranked:
                    rows[place, joint] = np.frombuffer(ranked[min(rank, len(ranked) - 1)][1], dtype=np.int32)
        return rows


# Which of a joint's candidates, the best first, go into the last judgement.
RANKS = (0, 2, 8, 24)
KEPT = len(RANKS)


def _best_few(ranked: list[tuple[float, bytes]]) -> list[tuple[float, bytes]]:
    """The best different ones, the best first."""
    kept: dict[bytes, float] = {}
    for cost, raw in sorted(ranked):
        kept.setdefault(raw, cost)
    return [(cost, raw) for raw, cost in list(kept.items())[: RANKS[-1] + 1]]


@dataclass
class LockstepSearch:
    """One optimiser a joint on these costs, (n, 4) for controllers (n, 4, 13). The best goes into `found`."""

    costs: Costs
    found: SearchState
    journal: TuningJournal = field(default_factory=lambda: TuningJournal(None, {}))
    tick: Tick = lambda _: None  # called after each batch

    def try_again(self, stage: str) -> None:
        """Judge the best of all joints together, and forget all other costs, so that later candidates must beat that.

        A joint's cost depends on what its neighbours did in the same row. The best of many was also lucky in that, and
        neighbours have changed since.
        """
        self.found.forget_costs()
        self._evaluate(self.found.best[None].copy(), [1] * JOINTS, stage)

    def run(
        self,
        space: Space,
        *,
        stage: str,
        method: str,
        budget: int,
        seed: tuple[int, ...],
        start: Controllers | None = None,
        groups: Sequence[Sequence[int]] = TOGETHER,
        sigma: float | None = None,
        pack: int = PACK,
    ) -> None:
        """Spend `budget` evaluations a joint; a `start` (4, 13) is in the first pack.

        The first pack lies all over the box, or around `start` with a standard deviation of `sigma` times the box.
        CMA-ES has a pack of its own size. Joints of no group keep what they have.
        """
        points = np.empty((0, JOINTS, space.dimensions)) if start is None else space.points(start[None])
        packs: list[Optimiser] = []
        try:
            for joint in range(JOINTS):
                source = np.random.default_rng([*seed, joint])
                packs.append(_begin(method, space, budget, source, points[:, joint], sigma, pack))
            while not all(packs[joint].done for group in groups for joint in group):
                for group in groups:
                    if not all(packs[joint].done for joint in group):
                        self._run_batch(space, stage, packs, group)
                        self.tick(self.found)
        finally:
            for one in packs:
                one.close()

    def _run_batch(self, space: Space, stage: str, packs: list[Optimiser], group: Sequence[int]) -> None:
        """One round of ask and tell for some joints; the others run their best so far."""
        asked = [
            packs[joint].ask() if joint in group and not packs[joint].done else np.empty((0, space.dimensions))
            for joint in range(JOINTS)
        ]
        counts = [len(one) for one in asked]
        rows = np.repeat(self.found.best[None], max(counts), axis=0)
        for joint, points in enumerate(asked):
            if len(points):
                whole = np.repeat(points[:, None], JOINTS, axis=1)
                rows[: len(points), joint] = space.controllers(whole)[:, joint]
                self.found.narrowed += space.count_narrow(points[:, None])
        costs = self._evaluate(rows, counts, stage)
        for joint, one in enumerate(packs):
            if counts[joint]:
                one.tell(costs[: counts[joint], joint])

    def _evaluate(self, rows: Controllers, counts: list[int], stage: str) -> Floats:
        """Take the costs of candidates from the journal, or simulate them."""
        costs = self.journal.costs(stage, rows)
        if costs is None:
            costs = self.costs(rows)
            self.journal.tell(stage, rows, costs)
        self.found.take(rows, costs, counts)
        return costs


def _begin(
    method: str,
    space: Space,
    budget: int,
    source: np.random.Generator,
    start: Floats,
    sigma: float | None,
    pack: int,
) -> Optimiser:
    """One joint's optimiser with its start points (k, d)."""
    box: dict[str, Any] = {"lower": space.lower, "upper": space.upper, "budget": budget, "seed": source}
    if method == CmaEs.name:
        # It makes its own pack around the start.
        return create(method, **box, start=start, sigma=START_SIGMA_SHARE if sigma is None else sigma)
    if sigma is not None:
        start = _surround(space, start, sigma, source, pack)
    return create(method, **box, start=start, pack=pack)


def _surround(space: Space, start: Floats, sigma: float, source: np.random.Generator, pack: int) -> Floats:
    """A first pack (pack, d): the start point, and others around it that keep inside the box."""
    places = latin_hypercube(source, pack - len(start), space.dimensions)
    # Even numbers have a standard deviation of 1 between -sqrt(3) and sqrt(3).
    steps = sigma * np.sqrt(3.0) * (2.0 * places - 1.0)
    around = np.clip(start[:1] + steps * (space.upper - space.lower), space.lower, space.upper)
    return np.concatenate([start, around])
