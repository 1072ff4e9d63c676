"""The result of every method of identification: a model, and how certain it is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NotRequired, TypedDict

from greywhale.base.types import Floats
from greywhale.identify.combinations import Combination


class EstimateFacts(TypedDict):
    name: str  # joint1.alpha, ...
    means: str
    unit: str  # of white_box, value and standard_deviation
    white_box: float  # where it began
    value: float  # what was found
    standard_deviation: NotRequired[float]  # absent where the logs do not say it


class RivalFacts(TypedDict):
    order: str
    held_out_error: float  # in the same unit as that of orders_tried
    plant: list[float]  # the arm as a row of numbers


@dataclass(frozen=True)
class ParameterEstimate:
    """One identified number; `deviation` is its standard deviation, None where the method does not know it."""

    name: str
    means: str
    unit: str
    white_box: float
    value: float
    deviation: float | None

    def as_dict(self) -> EstimateFacts:
        facts: EstimateFacts = {
            "name": self.name,
            "means": self.means,
            "unit": self.unit,
            "white_box": self.white_box,
            "value": self.value,
        }
        if self.deviation is not None:
            facts["standard_deviation"] = self.deviation
        return facts


@dataclass(frozen=True)
class Rival:
    """A model of another structure that predicts the held-out data nearly as well; its plant (columns,)."""

    order: str
    held_out: float
    plant: Floats = field(repr=False)

    def as_dict(self) -> RivalFacts:
        return {"order": self.order, "held_out_error": self.held_out, "plant": self.plant.tolist()}


@dataclass(frozen=True)
class FoundModel:
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
