"""The request for a tuning: a model, and how much to search."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from greywhale.base.limits import changed
from greywhale.base.types import Controllers, NotedProgress
from greywhale.files.trajectory import Trajectory
from greywhale.tune.limits import TUNING_LIMITS, TuningLimits
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
    judging: TuningLimits = TUNING_LIMITS
    motion: Trajectory | None = None

    def facts(self) -> dict[str, Any]:
        """The facts that every journal must agree with."""
        others = changed(self.judging, TUNING_LIMITS)
        others = {name: value for name, value in others.items() if name not in ("quiet", "floors", "by_the_arm")}
        return {
            "model": self.model.name,
            "model_digest": self.model.digest,
            "strategy": self.strategy,
            "method": self.method,
            "budget": self.budget,
            "seed": self.seed,
            "quiet": self.judging.quiet,
            "before": self.before.tolist(),
        } | ({"judging": others} if others else {})
