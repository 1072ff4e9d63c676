"""The task of an identification, and the result that every method returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from greywhale.arm import ArmParameters
from greywhale.base.errors import UserError
from greywhale.base.types import Floats, Progress
from greywhale.identify.closed_loop import Loop
from greywhale.identify.combinations import Combination
from greywhale.identify.judge import FIT, Subject
from greywhale.protocol.firmware import JOINTS


@dataclass(frozen=True)
class Task:
    """The white box to start from, the logs made ready, and the seed of all random numbers.

    `begin` is an identified model of the same arm, made from other logs, to go on from.
    """

    white_box: ArmParameters
    subjects: tuple[Subject, ...]
    seed: int
    report: Progress
    begin: ArmParameters | None = None

    @property
    def fitted(self) -> tuple[Subject, ...]:
        return tuple(subject for subject in self.subjects if subject.role == FIT)

    @property
    def moving(self) -> tuple[int, ...]:
        """Joints that at least one fitted log moves."""
        return tuple(joint for joint in range(JOINTS) if any(one.log.moving[joint] for one in self.fitted))

    def loops(self) -> list[Loop]:
        """The fitted logs' closed loops, or none where the controller of one is not known."""
        tables = [subject.table for subject in self.fitted]
        if any(table is None for table in tables):
            return []
        return [Loop(one.log, one.table, self.white_box) for one in self.fitted if one.table is not None]

    def required_loops(self) -> list[Loop]:
        """The same, for a method that needs them."""
        loops = self.loops()
        if not loops:
            raise UserError(
                f"{self.fitted[0].log.log.name}: the paper's method needs the controller that the log was recorded "
                "with; give it with --controller."
            )
        return loops


@dataclass(frozen=True)
class ParameterEstimate:
    """One identified number; `deviation` is its standard deviation, None where the method does not know it."""

    name: str
    means: str
    unit: str
    white_box: float
    value: float
    deviation: float | None

    def as_dict(self) -> dict[str, Any]:
        facts = {"name": self.name, "means": self.means, "unit": self.unit}
        numbers = {"white_box": self.white_box, "value": self.value}
        return facts | numbers | ({} if self.deviation is None else {"standard_deviation": self.deviation})


@dataclass(frozen=True)
class Rival:
    """A model of another structure that predicts the held-out data nearly as well; its plant (columns,)."""

    order: str
    held_out: float
    plant: Floats = field(repr=False)

    def as_dict(self) -> dict[str, Any]:
        return {"order": self.order, "held_out_error": self.held_out, "plant": self.plant.tolist()}


@dataclass(frozen=True)
class Found:
    """A plant (columns,), zero angles (4,) rad, and how certain the method is of them.

    `draws` (n, columns) are plants drawn from the covariance: the fit allows them as well.
    `joints` are those that were identified. `orders` are the structures tried, with their held-out errors. `covariance`
    is of the searched numbers, in the order of the estimates. `open` are sentences about what the logs cannot show.
    """

    plant: Floats = field(repr=False)
    zero: Floats = field(repr=False)
    joints: tuple[int, ...]
    order: str
    estimates: tuple[ParameterEstimate, ...]
    open: tuple[str, ...]
    simulations: int
    simulated: float  # s, of arms, in windows and closed loops together
    complete: bool
    orders: tuple[tuple[str, float], ...] = ()
    rivals: tuple[Rival, ...] = ()
    combinations: tuple[Combination, ...] = ()
    covariance: Floats | None = field(default=None, repr=False)
    draws: Floats | None = field(default=None, repr=False)
    condition: float | None = None
    curve: tuple[float, ...] = ()
