"""The interface and the result of every method of tuning. The default and the paper's are two of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

from greywhale.base.types import Controllers
from greywhale.protocol.table import ParameterTable
from greywhale.tune.judge.following import Worse
from greywhale.tune.judge.held_out import HeldOut
from greywhale.tune.judge.margins import Margin
from greywhale.tune.search.journal import TuningJournal
from greywhale.tune.search.lockstep import SearchState

Costs = tuple[float, ...]


@dataclass(frozen=True)
class Judgement:
    """The chosen controllers (4, 13), and how they and those from before did."""

    after: Controllers
    cost_before: Costs
    cost_after: Costs
    notes: tuple[str, ...]
    margins_before: tuple[Margin, ...] = field(default=(), repr=False)
    margins: tuple[Margin, ...] = field(default=(), repr=False)
    held_out: tuple[HeldOut, ...] = ()
    worse: tuple[Worse, ...] = ()


class Method(Protocol):
    """A way to tune. It simulates with `table`, and keeps the best so far in `found`."""

    table: ParameterTable
    found: SearchState

    def facts(self) -> dict[str, Any]:
        """The facts that a journal must agree with, besides the request's own."""
        ...

    def search(self, journal: TuningJournal) -> None:
        """Spend the budget."""
        ...

    def cost_before(self) -> Costs:
        """The cost of the controllers from before, as the search sees it; called only after something was evaluated."""
        ...

    def judge(self) -> Judgement:
        """Judge the best more exactly than the search could."""
        ...
