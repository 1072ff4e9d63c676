"""What a tuning found: controllers before and after, the search's course, margins, and how both do on other motions."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from greywhale.measure import Evaluation
from greywhale.table import ParameterTable
from greywhale.trajectory import Trajectory
from greywhale.tune.floor import Floor
from greywhale.tune.margins import Margin
from greywhale.tune.search import Found

if TYPE_CHECKING:
    from greywhale.tune.model import Model

Floats = npt.NDArray[np.float64]
Controllers = npt.NDArray[np.int32]


@dataclass(frozen=True)
class Curve:
    """One joint's convergence: the best cost (of the search) after so many evaluations."""

    evaluations: tuple[int, ...]
    cost: tuple[float, ...]


def curves_of(found: Found) -> tuple[Curve, ...]:
    """One a joint, from the search's books."""
    at = tuple(evaluations for evaluations, _ in found.curve)
    return tuple(Curve(at, tuple(costs[joint] for _, costs in found.curve)) for joint in range(len(found.cost)))


@dataclass(frozen=True)
class HeldOut:
    """One motion that nothing was tuned on, in the bench's own arithmetic, on the estimated plant, with sensor noise.

    `floor` is what any controller could reach at that supply, None where it was not computed.
    """

    name: str
    motion: Trajectory = field(repr=False)
    before: Evaluation
    after: Evaluation
    floor: Floor | None
    time_s: Floats = field(repr=False)  # (rows,) from the moment the motors go on
    leader: Floats = field(repr=False)  # (rows, 4) rad
    angles_before: Floats = field(repr=False)  # (rows, 4) rad
    angles_after: Floats = field(repr=False)  # (rows, 4) rad

    @property
    def mse_before(self) -> Floats:
        return np.array([joint.mse for joint in self.before.joints])

    @property
    def mse_after(self) -> Floats:
        return np.array([joint.mse for joint in self.after.joints])

    @property
    def multiples(self) -> tuple[float | None, ...]:
        """The error after tuning as a multiple of the floor, of each joint and all; None where it means nothing."""
        return (None,) * (len(self.mse_after) + 1) if self.floor is None else self.floor.multiple(self.mse_after)

    def as_dict(self) -> dict[str, Any]:
        return {
            "motion": self.name,
            "floor_mse_rad2": None if self.floor is None else self.floor.mse.tolist(),
            "floor_bound_mse_rad2": None if self.floor is None else self.floor.bound.tolist(),
            "after_as_multiple_of_floor": list(self.multiples),
            "before": self.before.as_dict(),
            "after": self.after.as_dict(),
        }


@dataclass(frozen=True)
class Outcome:
    """`before` and `after` are int32 (4, 12), exactly what a board stores; costs are joints', judged like the winners.

    `table` is the one that everything was simulated with: the model's, but for the paper's method, whose control
    period is 20 ms.
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
    def steady(self) -> bool:
        """Whether every joint comes to rest in every scenario."""
        return all(margin.holds for margin in self.margins)

    def save(self, path: str | Path) -> None:
        """Write controller.toml."""
        from greywhale.tune.controller_file import save

        save(self, path)

    def as_dict(self) -> dict[str, Any]:
        """For JSON; numbers of the controllers raw, as in the parameter table."""
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
            "before": self.before.tolist(),
            "after": self.after.tolist(),
            "cost_before": list(self.cost_before),
            "cost_after": list(self.cost_after),
            "margins_before": [margin.as_dict() for margin in self.margins_before],
            "margins": [margin.as_dict() for margin in self.margins],
            "held_out": [one.as_dict() for one in self.held_out],
            "curves": [{"evaluations": list(one.evaluations), "cost": list(one.cost)} for one in self.curves],
            "notes": list(self.notes),
        }
