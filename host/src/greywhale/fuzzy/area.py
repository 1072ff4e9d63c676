"""The centroid of the area under clipped or scaled sets: as polynomials of the heights, exact but for a double's bits.

A set clipped at height h has, between its left edge a + (b - a) t and its right one d - (d - c) t, an area that is a
square polynomial of h and a moment that is a cubic one. Neighbours share such a shape too, clipped at the lower of
their heights; so the area under all is the sum of the sets' areas less what neighbours share. No sum over samples.
All places have -1 and 1 at the ends of the range.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from greywhale.base.types import Floats
from greywhale.fuzzy.table_law import Corners, TableLaw

ONE, ZERO = Fraction(1), Fraction(0)


@dataclass(frozen=True)
class Shape:
    """Area a1 h + a2 h^2 and moment m1 h + m2 h^2 + m3 h^3 below height h, which goes up to `top`."""

    area: tuple[Fraction, Fraction]
    moment: tuple[Fraction, Fraction, Fraction]
    top: Fraction = ONE

    def area_below(self, height: Floats) -> Floats:
        first, second = map(float, self.area)
        return height * (first + height * second)

    def moment_below(self, height: Floats) -> Floats:
        first, second, third = map(float, self.moment)
        return height * (first + height * (second + height * third))


def shapes(law: TableLaw) -> tuple[tuple[Shape, ...], tuple[Shape, ...]]:
    """Those of the output's sets, and of what each shares with the next one."""
    sets = [_within(corners) for corners in law.output.scaled()]
    own = [_shape(*corners) for corners in sets]
    if law.clipped:
        return tuple(own), tuple(_shared(one, after) for one, after in pairwise(sets))
    scaled = [Shape((sum(one.area, ZERO), ZERO), (sum(one.moment, ZERO), ZERO, ZERO)) for one in own]
    return tuple(scaled), ()


def centroid(law: TableLaw, heights: Sequence[Floats]) -> Floats:
    """The place of the centroid, -1 to 1, for the heights of the output's sets; all arrays have one shape."""
    own, shared = shapes(law)
    area = np.zeros_like(heights[0])
    moment = np.zeros_like(heights[0])
    for shape, height in zip(own, heights, strict=True):
        area += shape.area_below(height)
        moment += shape.moment_below(height)
    for shape, (one, after) in zip(shared, pairwise(heights), strict=False):
        both = np.minimum(np.minimum(one, after), float(shape.top))
        area -= shape.area_below(both)
        moment -= shape.moment_below(both)
    return moment / area


def _within(corners: Corners) -> Corners:
    a, b, c, d = (max(-ONE, min(ONE, corner)) for corner in corners)
    return a, b, c, d


def _shape(a: Fraction, b: Fraction, c: Fraction, d: Fraction, top: Fraction = ONE) -> Shape:
    left, right = b - a, d - c
    area = (d - a, -(left + right) / 2)
    moment = ((d * d - a * a) / 2, -(d * right + a * left) / 2, (right * right - left * left) / 6)
    return Shape(area, moment, top)


def _shared(one: Corners, after: Corners) -> Shape:
    """The shape below both: from the left edge of the right one to the right edge of the left one."""
    (a, b, _, _), (_, _, c, d) = after, one
    if d <= a:
        return Shape((ZERO, ZERO), (ZERO, ZERO, ZERO), ZERO)
    closing = (b - a) + (d - c)
    return _shape(a, b, c, d, min(ONE, (d - a) / closing) if closing else ONE)
