"""What every method of tuning is given, offers and returns. The default and the paper's are two of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

from greywhale.base.types import Controllers, NotedProgress
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.judge.margins import Margin
from greywhale.tune.model import Model
from greywhale.tune.search.journal import Journal
from greywhale.tune.search.lockstep import Found

Costs = tuple[float, ...]


@dataclass(frozen=True)
class Task:
    """A model to tune for, and how: `budget` evaluations, controllers `before` (4, 12), bounds in a file's units."""

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

    def request(self) -> dict[str, Any]:
        """The facts that every journal must agree with."""
        return {
            "model": self.model.name,
            "model_digest": self.model.digest,
            "strategy": self.strategy,
            "method": self.method,
            "budget": self.budget,
            "seed": self.seed,
            "before": self.before.tolist(),
        }


@dataclass(frozen=True)
class Judgement:
    """The chosen controllers (4, 12), and how they and those from before did."""

    after: Controllers
    cost_before: Costs
    cost_after: Costs
    notes: tuple[str, ...]
    margins_before: tuple[Margin, ...] = field(default=(), repr=False)
    margins: tuple[Margin, ...] = field(default=(), repr=False)
    held_out: tuple[HeldOut, ...] = ()


class Method(Protocol):
    """A way to tune. It simulates with `table`, and keeps the best so far in `found`."""

    table: ParameterTable
    found: Found

    def request(self) -> dict[str, Any]:
        """The facts that a journal must agree with, besides the task's own."""
        ...

    def search(self, journal: Journal) -> None:
        """Spend the budget."""
        ...

    def cost_before(self) -> Costs:
        """The cost of the controllers from before, as the search sees it; called only after something was evaluated."""
        ...

    def judge(self) -> Judgement:
        """Judge the best more exactly than the search could."""
        ...
