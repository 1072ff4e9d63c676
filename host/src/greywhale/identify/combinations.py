"""Quotients and products that the logs determine well, of numbers that they do not show one by one.

Motion in which gravity plays no part shows inertia per torque, for example, but neither alone. The estimate then lies
somewhere on a ridge, and the standard deviations of its numbers say little. The quotient's says much.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from greywhale.base.types import Floats
from greywhale.identify.limits import IDENTIFICATION_LIMITS, UncertaintyLimits
from greywhale.identify.space import Space


class CombinationFacts(TypedDict):
    name: str  # the numbers that it is made of, such as joint1.inertia / joint1.alpha
    value: float  # from theirs in their units
    relative_deviation: float  # standard deviation as a share of the value


@dataclass(frozen=True)
class Combination:
    """A quotient (or product) of two numbers of a joint; `deviation` is its standard deviation as a share of it."""

    name: str
    value: float
    deviation: float

    def as_dict(self) -> CombinationFacts:
        return {"name": self.name, "value": self.value, "relative_deviation": self.deviation}


def combinations(
    space: Space,
    x: Floats,
    covariance: Floats,
    limits: UncertaintyLimits = IDENTIFICATION_LIMITS.uncertainty,
) -> tuple[Combination, ...]:
    """For every uncertain number of a joint, its sharpest combination with another number, where that is far sharper.

    `covariance` is that of the searched numbers. Only positive quantities, whose logarithms are searched, take part.
    """
    deviations = np.sqrt(np.diag(covariance))
    found: dict[frozenset[int], Combination] = {}
    for first in range(len(space)):
        best: tuple[float, int, int] | None = None
        for second in range(len(space)):
            if not _may_combine(space, deviations, first, second, limits.uncertain):
                continue
            for sign in (-1, 1):
                variance = deviations[first] ** 2 + deviations[second] ** 2 + 2 * sign * covariance[first, second]
                deviation = math.sqrt(max(variance, 0.0))
                if best is None or deviation < best[0]:
                    best = deviation, second, sign
        if best is not None and limits.sharper * best[0] < min(deviations[first], deviations[best[1]]):
            found.setdefault(frozenset((first, best[1])), _state(space, x, first, *best[1:], best[0]))
    return tuple(found.values())


def _may_combine(space: Space, deviations: Floats, first: int, second: int, least: float) -> bool:
    one, other = space.parameters[first], space.parameters[second]
    positive = space.kind(first).logarithmic and space.kind(second).logarithmic
    uncertain = min(deviations[first], deviations[second]) > least
    return first != second and one.joint == other.joint and positive and uncertain


def _state(space: Space, x: Floats, first: int, second: int, sign: int, deviation: float) -> Combination:
    first, second = min(first, second), max(first, second)
    names = [space.parameters[index].name for index in (first, second)]
    if sign > 0:
        return Combination(f"{names[0]} x {names[1]}", math.exp(x[first] + x[second]), deviation)
    # The quotient is stated per unit of the number that comes first, which is alpha where alpha takes part.
    return Combination(f"{names[1]} / {names[0]}", math.exp(x[second] - x[first]), deviation)
