"""The integer arithmetic of a generated header, bit for bit, over numpy arrays.

It follows law.h.in function for function. Inputs and output are q14 of half their range: +-16384 are its ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from greywhale.base.types import Floats
from greywhale.fuzzy.area import Shape, shapes
from greywhale.fuzzy.table_law import NO_RULE, Corners, TableLaw

Ints = NDArray[np.int64]

END = 1 << 14  # of a range
FULL = (1 << 16) - 1  # height 1.0
AREA_UNIT = 1 << 28  # of an area or a moment, 1 in half the range; the whole range under 1 is 2
OUTSIDE = END + 1  # the nearest place where an edge may begin
QUOTIENT_BITS = 15


@dataclass(frozen=True)
class Flank:
    """One edge of a set: at distance d from `base`, `full` where 1 begins, height (slope d + offset) / 2^16."""

    base: int
    full: int
    slope: int
    offset: int


@dataclass(frozen=True)
class IntegerSet:
    rise: Flank
    fall: Flank


@dataclass(frozen=True)
class IntegerShape:
    """Coefficients in 1 / AREA_UNIT for heights of 16 bits, and the height at which a shared shape ends."""

    area: tuple[int, int]
    moment: tuple[int, int, int]
    top: int


@dataclass(frozen=True)
class IntegerLaw:
    inputs: tuple[tuple[IntegerSet, ...], tuple[IntegerSet, ...]]
    own: tuple[IntegerShape, ...]
    shared: tuple[IntegerShape, ...]
    table: Ints  # (sets of the first input, sets of the second)


def of_law(law: TableLaw) -> IntegerLaw:
    """The numbers that stand in the header."""
    first, second = (tuple(_set(corners) for corners in axis.scaled()) for axis in law.inputs)
    own, shared = (tuple(_shape(one) for one in many) for many in shapes(law))
    return IntegerLaw((first, second), own, shared, np.array(law.table, dtype=np.int64))


def memberships(sets: Sequence[IntegerSet], x: Ints) -> Ints:
    """Heights of all sets at places x, (sets, len(x)). Places lie within +-END."""
    found = np.zeros((len(sets), len(x)), dtype=np.int64)
    for height, one in zip(found, sets, strict=True):
        rising, falling = x - one.rise.base, one.fall.base - x
        on_rise, on_fall = x < one.rise.full, x > one.fall.full
        height[:] = FULL
        height[on_rise] = _height(one.rise, rising[on_rise])
        height[on_fall] = _height(one.fall, falling[on_fall])
    return found


def u(law: IntegerLaw, e: Ints, ce: Ints) -> Ints:
    """The output for places e and ce, q14."""
    return defuzzify(law, heights(law, memberships(law.inputs[0], e), memberships(law.inputs[1], ce)))


def heights(law: IntegerLaw, of_e: Ints, of_ce: Ints) -> Ints:
    """The heights of the output's sets, (sets, places), from the memberships at the places."""
    found = np.zeros((len(law.own), of_e.shape[1]), dtype=np.int64)
    for (i, j), then in np.ndenumerate(law.table):
        if then != NO_RULE:
            np.maximum(found[then], np.minimum(of_e[i], of_ce[j]), out=found[then])
    return found


def defuzzify(law: IntegerLaw, found: Ints) -> Ints:
    """Area and moment, summed as the header does, and their quotient, half away from zero."""
    area = np.zeros(found.shape[1], dtype=np.int64)
    moment = np.zeros_like(area)
    for shape, height in zip(law.own, found, strict=True):
        area += _area(shape, height)
        moment += _moment(shape, height)
    for shape, (one, after) in zip(law.shared, pairwise(found), strict=False):
        both = np.minimum(np.minimum(one, after), shape.top)
        area -= _area(shape, both)
        moment -= _moment(shape, both)
    size = (np.minimum(np.abs(moment), area) << QUOTIENT_BITS) // np.maximum(area, 1)
    size = (size + 1) >> 1
    return np.where(moment < 0, -size, size)


def _scale(factor: Ints | int, height: Ints) -> Ints:
    return (factor * height) >> 16


def _area(shape: IntegerShape, height: Ints) -> Ints:
    first, second = shape.area
    return _scale(first + _scale(second, height), height)


def _moment(shape: IntegerShape, height: Ints) -> Ints:
    first, second, third = shape.moment
    return _scale(first + _scale(second + _scale(third, height), height), height)


def _height(flank: Flank, distance: Ints) -> Ints:
    return np.where(distance <= 0, 0, ((flank.slope * distance + flank.offset) & 0xFFFFFFFF) >> 16)


def _set(corners: Corners) -> IntegerSet:
    a, b, c, d = (corner * END for corner in corners)
    rise, fall = _flank(a, b), _flank(-d, -c)
    return IntegerSet(rise, Flank(-fall.base, -fall.full, fall.slope, fall.offset))


def _flank(foot: Fraction, shoulder: Fraction) -> Flank:
    """A rising edge; a falling one is its mirror image."""
    base = max(math.floor(foot), -OUTSIDE)
    full = max(-OUTSIDE, min(math.ceil(shoulder), OUTSIDE))
    width = shoulder - foot
    if full <= -END or width == 0:
        return Flank(base, full, 0, 0)
    if width < 1:  # one place at most lies on it
        at = FULL * (base + 1 - foot) / width
        return Flank(base, full, 0, round(min(max(at, Fraction(0)), Fraction(FULL)) * 65536))
    slope = FULL * 65536 / width
    return Flank(base, full, round(slope), round(slope * (base - foot)) + 32768)


def _shape(shape: Shape) -> IntegerShape:
    step = Fraction(65536, FULL)  # heights count FULL for 1, and products are shifted by 16

    def stored(value: Fraction, power: int) -> int:
        return round(value * AREA_UNIT * step**power)

    a1, a2 = (stored(value, power) for power, value in enumerate(shape.area, start=1))
    m1, m2, m3 = (stored(value, power) for power, value in enumerate(shape.moment, start=1))
    return IntegerShape((a1, a2), (m1, m2, m3), math.floor(shape.top * FULL))


def axis_heights(sets: Sequence[Corners], x: Floats) -> Floats:
    """Exact memberships at places x in -1..1, but for a double's bits: what `memberships` comes close to."""
    rows = []
    for a, b, c, d in (map(float, corners) for corners in sets):
        up = np.where(x >= b, 1.0, (x - a) / (b - a) if b > a else 0.0)
        down = np.where(x <= c, 1.0, (d - x) / (d - c) if d > c else 0.0)
        rows.append(np.clip(np.minimum(up, down), 0.0, 1.0))
    return np.array(rows)
