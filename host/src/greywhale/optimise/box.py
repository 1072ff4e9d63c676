"""The search box: lower and upper bounds, the unit coordinates in it, and the first pack scattered over it."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.types import Floats


class Source(Protocol):
    """The source of all random numbers: numpy's Generator, or a script in a test."""

    def random(self, size: tuple[int, ...], /) -> Floats:
        """Uniform numbers in [0, 1)."""
        ...


class Box:
    """Bounds of every coordinate; `lower` < `upper`, both finite."""

    def __init__(self, lower: ArrayLike, upper: ArrayLike) -> None:
        low, high = np.broadcast_arrays(np.asarray(lower, dtype=float), np.asarray(upper, dtype=float))
        if low.ndim != 1 or low.size == 0:
            raise ValueError(f"bounds must be one list of numbers each, not of shape {low.shape}")
        for index, (a, b) in enumerate(zip(low, high, strict=True)):
            # Also the width: [-1e308, 1e308] has finite bounds and none.
            if not (np.isfinite(a) and np.isfinite(b) and a < b and b - a < np.inf):
                raise ValueError(
                    f"bounds of coordinate {index} are {a:g} and {b:g}; give two finite ones, the lower first"
                )
        self.lower: Floats = low.copy()
        self.upper: Floats = high.copy()

    @property
    def dimensions(self) -> int:
        return len(self.lower)

    @property
    def width(self) -> Floats:
        return self.upper - self.lower

    def from_unit(self, unit: Floats) -> Floats:
        """Points of the unit cube, placed in the box (and never outside by rounding)."""
        return self.clip(self.lower + unit * self.width)

    def to_unit(self, points: Floats) -> Floats:
        unit: Floats = (points - self.lower) / self.width
        return np.clip(unit, 0.0, 1.0)

    def clip(self, points: Floats) -> Floats:
        return np.clip(points, self.lower, self.upper)

    def check_inside(self, points: ArrayLike) -> Floats:
        """Points given by a caller, as an array of rows; refused when one lies outside."""
        rows = np.atleast_2d(np.asarray(points, dtype=float))
        if rows.ndim != 2 or rows.shape[1] != self.dimensions:
            raise ValueError(f"start points must have {self.dimensions} coordinates each, not shape {rows.shape}")
        outside = np.argwhere(~((rows >= self.lower) & (rows <= self.upper)))
        if len(outside):
            row, column = (int(index) for index in outside[0])
            raise ValueError(
                f"coordinate {column} of start point {row} is {rows[row, column]:g}, "
                f"outside [{self.lower[column]:g}, {self.upper[column]:g}]"
            )
        return rows


def scatter(source: Source, count: int, dimensions: int) -> Floats:
    """Independent uniform points of the unit cube."""
    return source.random((count, dimensions))


def latin_hypercube(source: Source, count: int, dimensions: int) -> Floats:
    """Points of the unit cube, one in each of `count` equal slices of every coordinate."""
    slices = np.argsort(source.random((count, dimensions)), axis=0, kind="stable")
    return (slices + source.random((count, dimensions))) / count
