"""Tells a gain from chance: measured errors against predicted ones, stretch by stretch, under the same leader.

A person never makes the same motion twice, so two raw errors say little. But the model predicts what the set from
before would have done under just this leader. It is wrong by some factor, which the stretches with the set from before
show. What is left is compared: the sum of measured errors over the sum of predicted ones, and how much that ratio
differs from group to group of stretches.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from greywhale.adapt.limits import ADAPTATION_LIMITS, GainLimits
from greywhale.base.types import Floats

# Student's t for one-sided 99 %, from this many groups on, one less being the degrees of freedom; the last is that of a
# normal distribution.
LEAST_GROUPS = 3
T_99 = (6.965, 4.541, 3.747, 3.365, 3.143, 2.998, 2.896, 2.821, 2.764, 2.718, 2.681, 2.650, 2.624, 2.602, 2.326)


@dataclass(frozen=True)
class Scale:
    """Measured errors of a set beside the predicted ones: `factor` (4,) between them, `weight` (4,) 1/rad² that makes
    every joint count the same; `usual` is a stretch's error in that unit, `deviation` that of the whole, as a share.
    """

    factor: Floats
    weight: Floats
    usual: float
    deviation: float

    @classmethod
    def of(cls, measured: Floats, predicted: Floats, limits: GainLimits = ADAPTATION_LIMITS.gain) -> Self:
        """From the errors (n, 4) of n stretches."""
        least = limits.pot_noise_rad2
        factor = (measured.sum(axis=0) + least) / (predicted.sum(axis=0) + least)
        weight = 1.0 / (measured.mean(axis=0) + least)
        seen = measured @ weight
        ratio = Ratio.of(seen, (factor * predicted) @ weight, limits.group_s)
        return cls(factor, weight, float(seen.mean()), ratio.deviation)

    @property
    def error(self) -> float:
        """By what factor (a logarithm) the model is wrong, over all joints."""
        return float(np.abs(np.log(self.factor)).max())

    def expected(self, predicted: Floats) -> Floats:
        """Return the errors to expect, (n,) in units of the joints' usual errors, from predicted ones (n, 4)."""
        found: Floats = (self.factor * predicted) @ self.weight
        return found

    def seen(self, measured: Floats) -> Floats:
        """Return measured errors (n, 4) as (n,) in units of the joints' usual errors."""
        found: Floats = measured @ self.weight
        return found


@dataclass(frozen=True)
class Ratio:
    """A ratio of two sums over stretches; `deviation` is its standard deviation as a share, inf for too few."""

    value: float
    deviation: float
    groups: int

    @classmethod
    def of(cls, above: Floats, below: Floats, group_s: int = ADAPTATION_LIMITS.gain.group_s) -> Self:
        """From values (n,) each, in the order of time; so many neighbours count as one observation."""
        groups = len(above) // group_s
        if groups < LEAST_GROUPS:
            return cls(float(above.sum() / max(below.sum(), 1e-12)), float("inf"), groups)
        tops, bottoms = (one[: groups * group_s].reshape(groups, group_s).sum(axis=1) for one in (above, below))
        value = float(tops.sum() / bottoms.sum())
        left = tops - value * bottoms
        deviation = np.sqrt(groups / (groups - 1.0) * np.sum(left**2)) / bottoms.sum() / value
        return cls(value, float(deviation), groups)

    def within(self, more: float) -> tuple[float, float]:
        """Return the bounds of the ratio, each side with 99 %; `more` is a further deviation, as a share."""
        if not np.isfinite(self.deviation):
            return 0.0, float("inf")
        wide = float(np.exp(T_99[min(self.groups - LEAST_GROUPS, len(T_99) - 1)] * np.hypot(self.deviation, more)))
        return self.value / wide, self.value * wide
