"""The box that a search works in, and the way from a point in it to a controller that the firmware accepts.

A point is decoded to the int32 numbers of the parameter table first. So what is simulated is what will be uploaded, bit
for bit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import numpy.typing as npt

from greywhale.base.elementary import exp, log
from greywhale.base.errors import BadUsage
from greywhale.base.types import Controllers, Floats
from greywhale.files.controller import NARROWEST_FLANK
from greywhale.fuzzy.settings import (
    GAIN_UNIT,
    LARGEST_KI,
    LARGEST_KI_PERIOD,
    LARGEST_KU_MV,
    LEAST_WIDTH,
    MOST_CE_TICKS,
    SET_UNIT,
)
from greywhale.loop import CONTROLLER_COLUMNS
from greywhale.protocol import schema
from greywhale.tune.limits import TUNING_LIMITS, SpaceLimits

STRATEGIES = ("mf", "sf", "both")

Bounds = Mapping[str, tuple[float, float]]

# The paper's names (Tables 8 to 10) in the order of its vector w (section 4), then the scaling factors.
SETS = ("Ne_c", "Ze_a", "Ze_c", "Pe_b", "Nce_c", "Zce_a", "Zce_c", "Pce_b")
GAINS = ("Kp", "Kd", "Ki", "Ku")
CE_TICKS = "ce_ticks"  # searched with the factors, but not by the paper
NAMES = (*SETS, *GAINS, CE_TICKS)
_PAIRS = (("Ne_c", "Pe_b"), ("Ze_a", "Ze_c"), ("Nce_c", "Pce_b"), ("Zce_a", "Zce_c"))
_NEGATIVE = frozenset({"Ne_c", "Ze_a", "Nce_c", "Zce_a"})
_UNIT = {"Kp": GAIN_UNIT, "Kd": GAIN_UNIT, "Ki": GAIN_UNIT, "Ku": 1000, CE_TICKS: 1}
NARROWEST = LEAST_WIDTH / SET_UNIT

# Upper bounds of the paper's scaling factors. Ku = 20 V is visible in Table 8. For the others the paper prints none; 3
# is the next whole number above all of Tables 8 and 9 (the largest is Ki = 2.072).
_PAPER_GAIN_MAX = {"Kp": 3.0, "Kd": 3.0, "Ki": 3.0, "Ku": 20.0}


def _column(name: str) -> int:
    return CONTROLLER_COLUMNS.index("ku_mv" if name == "Ku" else name.lower())


@dataclass(frozen=True)
class Variable:
    """One searched number: `low` to `high` in the file's unit and sign, searched by its logarithm or as it is.

    `offset` is added to a size before the logarithm is taken, so that it may be 0. `mirror` is another corner that gets
    the same size on the other side of zero.
    """

    name: str
    low: float
    high: float
    logarithmic: bool
    mirror: str = ""
    offset: float = 0.0

    @property
    def column(self) -> int:
        """Its place in a joint's row of the parameter table."""
        return _column(self.name)

    @property
    def unit(self) -> int:
        """The number of raw steps in one of the file's units."""
        return _UNIT.get(self.name, SET_UNIT)

    @property
    def bounds(self) -> tuple[float, float]:
        """In search units: logarithms of sizes, or the values themselves."""
        if not self.logarithmic:
            return self.low, self.high
        sizes = sorted((abs(self.low), abs(self.high)))
        low, high = map(float, log(np.array(sizes) + self.offset))
        return low, high

    def raw(self, x: Floats) -> npt.NDArray[np.int64]:
        """The nearest numbers that the board can store; a width below 0.01 becomes 0.01."""
        sign = -1.0 if self.name in _NEGATIVE else 1.0
        size = exp(x) - self.offset if self.logarithmic else sign * x
        # A size of 0 comes back from its logarithm with an error of rounding.
        raw = np.maximum(np.rint(size * self.unit), 0.0).astype(np.int64)
        if self.name in SETS:
            raw = np.clip(raw, LEAST_WIDTH, SET_UNIT)
        return np.asarray(sign * raw, dtype=np.int64)

    def search_value(self, raw: npt.NDArray[np.int32]) -> Floats:
        """The point of a stored number, moved into the box where it lies outside."""
        value = raw.astype(np.float64) / self.unit
        if self.logarithmic:
            value = log(np.maximum(np.abs(value) + self.offset, 1e-9))
        return np.clip(value, *self.bounds)


@dataclass(frozen=True)
class Space:
    """The box of one strategy, the same for every joint; all other numbers stay as in `base` (4, 13)."""

    strategy: str
    variables: tuple[Variable, ...]
    base: Controllers
    limits: SpaceLimits = TUNING_LIMITS.space

    @classmethod
    def default(
        cls,
        strategy: str,
        base: Controllers,
        supply_mv: int,
        period_ms: int,
        limits: SpaceLimits = TUNING_LIMITS.space,
    ) -> Self:
        """Widths from 0.01 to 1, and factors over decades by their logarithms, Ku up to twice the supply."""
        sets = [Variable(name, *_ordered(name, NARROWEST, 1.0), True) for name in SETS]
        largest_ku = min(limits.ku_beyond * supply_mv, LARGEST_KU_MV) / 1000.0
        gains = [
            Variable("Kp", *limits.kp_range, True),
            Variable("Kd", *limits.kd_range, True),
            Variable("Ki", 0.0, largest_ki(period_ms), True, offset=limits.slow_ki),
            Variable("Ku", min(limits.least_ku_v, 0.5 * largest_ku), largest_ku, False),
            Variable(CE_TICKS, 1.0, float(MOST_CE_TICKS), True),
        ]
        return cls(strategy, _chosen(strategy, sets, gains), base, limits)

    @classmethod
    def paper(cls, strategy: str, base: Controllers) -> Self:
        """Table 7's bounds: sets from -1 to 0 and from 0 to 1; scaling factors from 0."""
        sets = [Variable(name, *_ordered(name, 0.0, 1.0), False) for name in SETS]
        gains = [Variable(name, 0.0, _PAPER_GAIN_MAX[name], False) for name in GAINS]
        return cls(strategy, _chosen(strategy, sets, gains), base)

    def with_bounds(self, bounds: Bounds, period_ms: int = 1) -> Self:
        """Return the box with other bounds for some variables, which `check_bounds` must have passed."""
        most = largest_ki(period_ms)
        if "Ki" in bounds and bounds["Ki"][1] > most:
            raise BadUsage(
                f"the bounds of Ki reach to {bounds['Ki'][1]:g}, but at a control period of {period_ms} ms the "
                f"firmware takes at most {most:g}."
            )
        changed = [
            replace(variable, low=bounds[variable.name][0], high=bounds[variable.name][1])
            if variable.name in bounds
            else variable
            for variable in self.variables
        ]
        return replace(self, variables=tuple(changed))

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(variable.name for variable in self.variables)

    @property
    def dimensions(self) -> int:
        return len(self.variables)

    @property
    def lower(self) -> Floats:
        return np.array([variable.bounds[0] for variable in self.variables])

    @property
    def upper(self) -> Floats:
        return np.array([variable.bounds[1] for variable in self.variables])

    def controllers(self, points: Floats) -> Controllers:
        """Points (n, 4, d) in search units as controllers that the firmware stores: int32 (n, 4, 13)."""
        rows = np.repeat(self.base[None], len(points), axis=0).astype(np.int64)
        for place, variable in enumerate(self.variables):
            raw = variable.raw(points[:, :, place])
            rows[:, :, variable.column] = raw
            if variable.mirror:
                rows[:, :, _column(variable.mirror)] = -raw
        return rows.astype(np.int32)

    def points(self, controllers: Controllers) -> Floats:
        """Controllers (n, 4, 13) as points (n, 4, d), moved into the box where they lie outside."""
        columns = [variable.search_value(controllers[:, :, variable.column]) for variable in self.variables]
        return np.stack(columns, axis=-1)

    def reduce(self) -> Self:
        """The part of the box in which the shape of the law differs.

        Sets are the same on both sides of zero. Where factors and sets are both searched, Kp and Kd are as near to
        their usual values as their bounds allow, since they only stretch the axes of the sets.
        """
        by_name = {variable.name: variable for variable in self.variables}
        for left, right in _PAIRS:
            if left in by_name and right in by_name:
                both = _mirrored(by_name[left], by_name[right])
                if both is not None:
                    by_name[right] = both
                    del by_name[left]
        base = self.base.copy()
        if self.strategy == "both":
            for name, usual in (("Kp", self.limits.usual_kp), ("Kd", self.limits.usual_kd)):
                variable = by_name.pop(name)
                base[:, variable.column] = round(float(np.clip(usual, variable.low, variable.high) * variable.unit))
        return replace(self, variables=tuple(by_name.values()), base=base)

    def restretch(self, controllers: Controllers) -> Controllers:
        """Return the laws (4, 13) with Kp and Kd of `base` where this space does not search them: the sets are
        stretched instead.
        """
        rows = controllers.astype(np.float64)
        for gain, sets in (("Kp", SETS[:4]), ("Kd", SETS[4:])):
            if gain in self.names or not set(self.names) & set(sets):
                continue
            factor = self.base[:, _column(gain)] / np.maximum(rows[:, _column(gain)], 1.0)
            for name in sets:
                size = np.clip(np.abs(rows[:, _column(name)]) * factor, LEAST_WIDTH, SET_UNIT)
                rows[:, _column(name)] = np.sign(rows[:, _column(name)]) * size
            rows[:, _column(gain)] = self.base[:, _column(gain)]
        return np.rint(rows).astype(np.int32)

    def count_narrow(self, points: Floats) -> int:
        """Count the numbers of these points (n, 4, d) that have a width below 0.01, which `controllers` widens."""
        count = 0
        for place, variable in enumerate(self.variables):
            if variable.name in SETS and not variable.logarithmic:
                count += int((np.rint(np.abs(points[:, :, place]) * SET_UNIT) < LEAST_WIDTH).sum())
        return count


def largest_ki(period_ms: int) -> float:
    """The largest Ki that the firmware's arithmetic holds at a control period."""
    return min((LARGEST_KI_PERIOD - 1) // period_ms, LARGEST_KI) / GAIN_UNIT


def check_strategy(strategy: str) -> None:
    """Refuse a strategy that does not exist."""
    if strategy not in STRATEGIES:
        raise BadUsage(f"there is no strategy {strategy!r}; there are {', '.join(STRATEGIES)}.")


def check_bounds(strategy: str, bounds: Bounds) -> None:
    """Refuse bounds (in the file's units and signs) that the strategy does not search or no board can store."""
    for name, (low, high) in bounds.items():
        if name not in NAMES:
            raise BadUsage(f"there is no bound for {name!r}; there are {', '.join(NAMES)}.")
        if name in ((*GAINS, CE_TICKS) if strategy == "mf" else SETS if strategy == "sf" else ()):
            raise BadUsage(f"{name} is not searched by strategy {strategy}; leave out its bounds.")
        if not (math.isfinite(low) and math.isfinite(high)):
            raise BadUsage(f"the bounds of {name} are {low:g} and {high:g}; give two finite numbers.")
        if low >= high:
            raise BadUsage(f"the bounds of {name} are {low:g} and {high:g}; give the lower one first.")
        least, most = storable_range(name)
        if not (least <= low and high <= most):
            raise BadUsage(
                f"the bounds of {name} are {low:g} and {high:g}, but they must lie within {least:g}..{most:g}."
            )


def storable_range(name: str) -> tuple[float, float]:
    """The smallest and the largest value that may bound a variable in a search."""
    if name in SETS:
        return _ordered(name, NARROWEST_FLANK, 1.0)
    parameter = schema.PARAMETER_BY_NAME["joint0.ku_mv" if name == "Ku" else f"joint0.{name.lower()}"]
    # A factor is searched by its logarithm, so 0 cannot be a bound; one step of the format serves as well.
    return 1.0 / _UNIT[name], parameter.maximum / _UNIT[name]


def _mirrored(left: Variable, right: Variable) -> Variable | None:
    """One variable for both sides, within the bounds of both; None where both have no size in common."""
    low, high = max(right.low, -left.high), min(right.high, -left.low)
    return replace(right, low=low, high=high, mirror=left.name) if low < high else None


def _ordered(name: str, small: float, large: float) -> tuple[float, float]:
    return (-large, -small) if name in _NEGATIVE else (small, large)


def _chosen(strategy: str, sets: Sequence[Variable], gains: Sequence[Variable]) -> tuple[Variable, ...]:
    check_strategy(strategy)
    return (*(sets if strategy != "sf" else ()), *(gains if strategy != "mf" else ()))
