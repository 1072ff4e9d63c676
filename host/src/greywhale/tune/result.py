"""The outcome of a tuning: controllers before and after, the search's course, margins, errors on other motions."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, TypedDict

from greywhale.base.types import Controllers, PerJoint
from greywhale.protocol.schema import PARAMETER_BY_NAME
from greywhale.protocol.table import CONTROLLER_COLUMNS, ParameterTable, physical
from greywhale.tune.judge.following import Worse, WorseFacts
from greywhale.tune.judge.held_out import HeldOut, HeldOutFacts
from greywhale.tune.judge.margins import AT_REST, TEETH, Margin, MarginFacts
from greywhale.tune.model import Model
from greywhale.tune.search.lockstep import SearchState
from greywhale.tune.search.space import STRATEGIES
from greywhale.tune.travel import TravelFacts


@dataclass(frozen=True)
class Curve:
    """One joint's convergence: the best cost (of the search) after so many evaluations."""

    evaluations: tuple[int, ...]
    cost: tuple[float, ...]


def curves_of(found: SearchState) -> tuple[Curve, ...]:
    """One curve a joint, from the search's books."""
    at = tuple(evaluations for evaluations, _ in found.curve)
    return tuple(Curve(at, tuple(costs[joint] for _, costs in found.curve)) for joint in range(len(found.cost)))


# As `greywhale params get` shows them, a joint in use each.
_COLUMNS = "|".join(CONTROLLER_COLUMNS)
ByName = Annotated[
    dict[str, float],
    ("propertyNames", {"pattern": rf"^joint[0-3]\.({_COLUMNS})$"}),
    ("patternProperties", {"_(mv|ticks)$": {"type": "integer"}}),
    ("minProperties", len(CONTROLLER_COLUMNS)),
]


class CurveFacts(TypedDict):
    evaluations: list[int]  # made until then
    cost: list[float]  # the best after so many


class TuningFacts(TypedDict):
    model: str  # what the model file calls its arm
    strategy: Annotated[str, ("enum", [*STRATEGIES])]  # searched: mf: membership functions, sf: scaling factors
    method: str  # default, paper, or the optimiser
    seed: int
    budget: int  # evaluations of each joint's controller
    evaluations: int  # that were made
    complete: bool  # false where it was interrupted
    period_ms: int  # of the control
    supply_v: float
    before: ByName  # the controllers before the tuning: parameter to value
    after: ByName
    cost_before: PerJoint[float]  # 0: the floor, 1: before the tuning (the paper's method: J in rad s² + V s²)
    cost_after: PerJoint[float]
    margins_before: list[MarginFacts]  # whether each joint comes to rest: a scenario and a joint each
    margins: list[MarginFacts]  # with the controllers after; empty where the tuning was interrupted
    held_out: list[HeldOutFacts]  # motions that nobody trained on
    follows_worse: list[WorseFacts]  # joints that the model sees follow a motion worse than before
    curves: PerJoint[CurveFacts]
    travel: TravelFacts | None  # null: the board's own numbers stay
    notes: list[str]


@dataclass(frozen=True)
class TuningResult:
    """The controllers `before` and `after`, int32 (4, 13), exactly as a board stores them, and how they do.

    Costs are the joints', judged like the winners. `table` is the one with which everything was simulated: the model's,
    except for the paper's method, whose control period is 20 ms.
    """

    model: Model
    table: ParameterTable = field(repr=False)
    strategy: str
    method: str
    seed: int
    budget: int
    evaluations: int
    complete: bool
    before: Controllers
    after: Controllers
    cost_before: tuple[float, ...]
    cost_after: tuple[float, ...]
    curves: tuple[Curve, ...] = field(repr=False)
    margins_before: tuple[Margin, ...] = field(repr=False)
    margins: tuple[Margin, ...] = field(repr=False)
    held_out: tuple[HeldOut, ...]
    worse: tuple[Worse, ...]  # joints that follow a motion worse than before, by the model
    notes: tuple[str, ...]

    @property
    def period_ms(self) -> int:
        """The control period that the controllers were simulated with."""
        return self.table.period_ms

    @property
    def supply_v(self) -> float:
        """The supply that they were simulated with."""
        return self.table.supply_v

    @property
    def board_table(self) -> ParameterTable:
        """The table with what the controller file says: the controllers, and the travel where the model knows it."""
        travel = self.model.travel
        return self.table.with_controllers(self.after).with_raw({} if travel is None else travel.raw())

    @property
    def lost_margins(self) -> tuple[Margin, ...]:
        """The margins that fail on more plants than with the controllers from before."""
        before = {(one.scenario, one.joint): one.plants_failing for one in self.margins_before}
        return tuple(one for one in self.margins if one.plants_failing > before.get((one.scenario, one.joint), 0))

    @property
    def steady(self) -> bool:
        """True where every joint rests on the arm as it is, and wherever else it did before, but for softer teeth."""
        resting = all(margin.holds for margin in self.margins if margin.scenario == AT_REST)
        return resting and all(margin.scenario == TEETH for margin in self.lost_margins)

    @property
    def worse_sentences(self) -> list[str]:
        """A sentence for the joints that follow worse than before, if there are any."""
        said = "; ".join(one.words for one in self.worse)
        return [f"FOLLOWS WORSE than before, by the model: {said}."] if said else []

    def as_dict(self) -> TuningFacts:
        return {
            "model": self.model.name,
            "strategy": self.strategy,
            "method": self.method,
            "seed": self.seed,
            "budget": self.budget,
            "evaluations": self.evaluations,
            "complete": self.complete,
            "period_ms": self.period_ms,
            "supply_v": self.supply_v,
            "before": self._named(self.before),
            "after": self._named(self.after),
            "cost_before": list(self.cost_before),
            "cost_after": list(self.cost_after),
            "margins_before": [margin.as_dict() for margin in self.margins_before],
            "margins": [margin.as_dict() for margin in self.margins],
            "held_out": [one.as_dict() for one in self.held_out],
            "follows_worse": [one.as_dict() for one in self.worse],
            "curves": [{"evaluations": list(one.evaluations), "cost": list(one.cost)} for one in self.curves],
            "travel": None if self.model.travel is None else self.model.travel.as_dict(),
            "notes": list(self.notes),
        }

    def _named(self, controllers: Controllers) -> dict[str, float]:
        """The controllers of the joints in use by their parameters' names, in their units."""
        table = self.table.with_controllers(controllers)
        names = [f"joint{joint}.{key}" for joint in self.model.arm.joints_in_use for key in CONTROLLER_COLUMNS]
        return {name: physical(PARAMETER_BY_NAME[name], table[name]) for name in names}
