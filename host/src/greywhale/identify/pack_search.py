"""A pack that searches arms in the closed loop, for the least summed mean squared error of the paper's Eq. 5."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.base.types import Floats, Progress
from greywhale.identify.closed_loop import Loop
from greywhale.optimise import create

AGENTS = 10  # the paper's
ITERATIONS = 50  # the paper's
BUDGET = AGENTS * (ITERATIONS + 1)


@dataclass
class PackSearch(ABC):
    """The search, with the paper's agents and iterations, and the best that it has found so far."""

    said: ClassVar[str]  # what it is, for people who wait

    arm: ArmParameters
    loops: Sequence[Loop]
    seed: int
    report: Progress
    optimiser: str = "gwo-woa"
    x: Floats | None = None
    curve: list[float] = field(default_factory=list)  # best cost of the first pack and after each iteration: Fig. 6
    simulations: int = 0
    complete: bool = False

    @abstractmethod
    def bounds(self) -> tuple[Floats, Floats]:
        """The lowest and highest values (numbers,)."""

    @abstractmethod
    def start(self) -> Floats | None:
        """Points (n, numbers) that the first pack holds."""

    @abstractmethod
    def plants(self, points: Floats) -> Floats:
        """The arms (n, columns) of searched points (n, numbers)."""

    def run(self) -> None:
        """Spend the budget. An interrupt after the first pack ends it early; before that, it is raised again."""
        try:
            self._run()
        except KeyboardInterrupt:
            if self.x is None:
                raise

    def _run(self) -> None:
        with create(
            self.optimiser, *self.bounds(), budget=BUDGET, seed=self.seed, start=self.start(), pack=AGENTS
        ) as pack:
            while not pack.done:
                points = pack.ask()
                pack.tell(self.costs(points))
                self.simulations += len(points)
                self.x = pack.best.x.copy()
                self.curve.append(float(pack.best.cost))
                self.report(self.said, self.simulations / BUDGET)
        self.complete = True

    def costs(self, points: Floats) -> Floats:
        """The error of each point, rad²: summed over the joints, the mean over the logs."""
        plants = self.plants(points)
        total: Floats = np.mean([loop.error(plants).sum(axis=1) for loop in self.loops], axis=0)
        return total

    @property
    def seconds(self) -> float:
        """Of arm that were simulated."""
        return self.simulations * sum(loop.seconds for loop in self.loops)
