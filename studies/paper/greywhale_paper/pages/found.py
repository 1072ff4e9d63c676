"""The results of a request by what they are about."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from greywhale.base.types import Controllers
from greywhale_paper.request import Request
from greywhale_paper.work import errata, optimisers
from greywhale_paper.work.arms import DEFAULT, STICKY

Result = Mapping[str, Any]


@dataclass(frozen=True)
class Found:
    """`results` by the keys of the tasks."""

    request: Request
    results: Mapping[str, Any]

    def __getitem__(self, key: str) -> Any:
        return self.results[key]

    def paper(self, arm: str = DEFAULT) -> list[Any]:
        """The paper's way on the bench with an arm, a result a seed."""
        return [self[f"paper {arm} {seed}"] for seed in self.request.every_seed]

    def untuned(self, name: str, period_ms: int, arm: str = DEFAULT) -> Any:
        """Printed controllers on the bench."""
        return self[f"bench {arm} {name} {period_ms}"]

    def identified(self, method: str, arm: str) -> list[Any]:
        """What a method of identification found on an arm, a result a seed."""
        if method == "paper" and arm in (DEFAULT, STICKY):
            return [run["identified"] for run in self.paper(arm)]
        seeds = self.request.arm_seeds if arm in self.request.drawn else self.request.every_seed
        return [self[f"identified {method} {arm} {seed}"] for seed in seeds]

    def default(self) -> list[Any]:
        """greywhale's own way on the bench, a result a seed."""
        return [self[f"default {seed}"] for seed in self.request.few_seeds]

    def grey_box(self, strategy: str) -> list[Any]:
        """The paper's tuning on the paper's arm, a result a seed."""
        return [self[f"grey box {strategy} {seed}"] for seed in self.request.every_seed]

    def problem(self, name: str) -> dict[str, list[Any]]:
        """The results of all optimisers on "identify" or "sets": method -> a result a seed."""
        seeds = self.request.every_seed
        return {method: [self[f"{name} {method} {seed}"] for seed in seeds] for method in optimisers.METHODS}

    def functions(self) -> dict[str, Any]:
        """Function -> setting -> method -> costs."""
        return {name: self[f"functions {name}"]["costs"] for name in optimisers.functions()}

    def errata(self) -> dict[str, Any]:
        return {name: self[f"errata {name}"] for name in errata.cases()}

    def objective(self) -> list[Any]:
        """What the paper's J rewards, a result a seed."""
        return [self[f"objective {seed}"] for seed in self.request.every_seed]

    @property
    def seeds(self) -> str:
        """How many, in words."""
        return _count(len(self.request.every_seed))

    @property
    def few_seeds(self) -> str:
        """Of greywhale's own tuning."""
        return _count(len(self.request.few_seeds))


def _count(seeds: int) -> str:
    return "one seed" if seeds == 1 else f"median of {seeds} seeds (lowest to highest)"


def controllers(result: Result) -> Controllers:
    """What a tuning found: int32 (4, 13)."""
    return np.array(result["controllers"], dtype=np.int32)
