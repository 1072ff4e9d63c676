"""What a tuning is asked: a model, and how much to search."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from greywhale.base.types import Controllers, NotedProgress
from greywhale.files.trajectory import Trajectory
from greywhale.tune.model import Model


@dataclass(frozen=True)
class TuningRequest:
    """A model to tune for, and how: `budget` evaluations, controllers `before` (4, 13), bounds in a file's units.

    `motion` takes the place of the training motions: what a certain person does with this arm.
    """

    model: Model
    strategy: str
    method: str
    budget: int
    seed: int
    threads: int
    before: Controllers
    bounds: dict[str, tuple[float, float]]
    report: NotedProgress
    floors: bool  # whether to work out the least possible error
    on_trial: bool = False  # whether the arm itself will judge what is found
    quiet: float = 1.0  # what divides the ripple that is allowed at rest
    motion: Trajectory | None = None

    def facts(self) -> dict[str, Any]:
        """The facts that every journal must agree with."""
        return {
            "model": self.model.name,
            "model_digest": self.model.digest,
            "strategy": self.strategy,
            "method": self.method,
            "budget": self.budget,
            "seed": self.seed,
            "quiet": self.quiet,
            "before": self.before.tolist(),
        }
