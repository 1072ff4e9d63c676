"""The standard test functions: minimum 0, a square box around the origin, cost of a whole batch of points at once.

`place` gives one of them as a problem: plain (as published), shifted (the minimum anywhere in the inner 80 % of the
same box) or rotated (shifted, and turned by a random rotation, so that coordinates no longer act one by one).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from greywhale.base.types import Floats

Setting = Literal["plain", "shifted", "rotated"]
SETTINGS: tuple[Setting, ...] = get_args(Setting)
# How much of the box's half width the minimum is moved into.
REACH = 0.8


@dataclass(frozen=True)
class Function:
    """`cost` of points relative to the function's own origin; every coordinate of its minimum is `minimum_at`."""

    name: str
    half_width: float
    minimum_at: float
    cost: Callable[[Floats], Floats]


@dataclass(frozen=True)
class Problem:
    """A function put somewhere; calling it gives the costs of a batch."""

    function: Function
    minimum: Floats
    rotation: Floats | None

    @property
    def lower(self) -> Floats:
        return np.full(len(self.minimum), -self.function.half_width)

    @property
    def upper(self) -> Floats:
        return np.full(len(self.minimum), self.function.half_width)

    def __call__(self, points: Floats) -> Floats:
        away = points - self.minimum
        if self.rotation is not None:
            away = away @ self.rotation.T
        return self.function.cost(away + self.function.minimum_at)


def place(function: Function, dimensions: int, setting: Setting, rng: np.random.Generator) -> Problem:
    """Place the function as a problem; `rng` gives everything random in it."""
    if setting == "plain":
        return Problem(function, np.full(dimensions, function.minimum_at), None)
    minimum = rng.uniform(-REACH, REACH, dimensions) * function.half_width
    rotation = random_rotation(dimensions, rng) if setting == "rotated" else None
    return Problem(function, minimum, rotation)


def random_rotation(dimensions: int, rng: np.random.Generator) -> Floats:
    """An orthogonal matrix, uniform over all of them."""
    q, r = np.linalg.qr(rng.standard_normal((dimensions, dimensions)))
    return q * np.sign(np.diag(r))


def _sum(terms: Floats) -> Floats:
    total: Floats = np.sum(terms, axis=1)
    return total


def _product(factors: Floats) -> Floats:
    product: Floats = np.prod(factors, axis=1)
    return product


def _elliptic(z: Floats) -> Floats:
    d = z.shape[1]
    return _sum(10.0 ** (6 * np.arange(d) / max(1, d - 1)) * z**2)


def _schwefel226(z: Floats) -> Floats:
    """The sum of 418.98 - z sin(sqrt |z|).

    Beyond its box of +-500, where shifting leads, it has deeper minima. It is continued there by its mirror image and
    the parabola of the CEC competitions.
    """
    around = np.mod(z + 500, 2000)
    inner = np.where(around <= 1000, around - 500, 1500 - around)
    penalty = np.maximum(np.abs(z) - 500, 0.0) ** 2 / (1e4 * z.shape[1])
    return _sum(418.9828872724338 - inner * np.sin(np.sqrt(np.abs(inner))) + penalty)


def _rosenbrock(z: Floats) -> Floats:
    return _sum(100 * (z[:, 1:] - z[:, :-1] ** 2) ** 2 + (1 - z[:, :-1]) ** 2)


def _zakharov(z: Floats) -> Floats:
    slope = _sum(0.5 * np.arange(1, z.shape[1] + 1) * z)
    return _sum(z**2) + slope**2 + slope**4


def _ackley(z: Floats) -> Floats:
    bowl = -20 * np.expm1(-0.2 * np.sqrt(np.mean(z**2, axis=1)))
    # expm1 of the difference, so that the minimum is 0 and not a few roundings beside it.
    ripples = -np.e * np.expm1(np.mean(np.cos(2 * np.pi * z), axis=1) - 1)
    total: Floats = bowl + ripples
    return total


def _griewank(z: Floats) -> Floats:
    waves = _product(np.cos(z / np.sqrt(np.arange(1, z.shape[1] + 1))))
    return _sum(z**2) / 4000 + (1 - waves)


def _levy(z: Floats) -> Floats:
    w = 1 + (z - 1) / 4
    inner = (w[:, :-1] - 1) ** 2 * (1 + 10 * np.sin(np.pi * w[:, :-1] + 1) ** 2)
    last = (w[:, -1] - 1) ** 2 * (1 + np.sin(2 * np.pi * w[:, -1]) ** 2)
    total: Floats = np.sin(np.pi * w[:, 0]) ** 2 + _sum(inner) + last
    return total


FUNCTIONS: dict[str, Function] = {
    function.name: function
    for function in (
        Function("sphere", 100.0, 0.0, lambda z: _sum(z**2)),
        Function("elliptic", 100.0, 0.0, _elliptic),
        Function("schwefel12", 100.0, 0.0, lambda z: _sum(np.cumsum(z, axis=1) ** 2)),
        Function("schwefel221", 100.0, 0.0, lambda z: np.abs(z).max(axis=1)),
        Function("schwefel222", 10.0, 0.0, lambda z: _sum(np.abs(z)) + _product(np.abs(z))),
        Function("rosenbrock", 30.0, 1.0, _rosenbrock),
        Function("zakharov", 10.0, 0.0, _zakharov),
        Function("rastrigin", 5.12, 0.0, lambda z: _sum(z**2 + 10 * (1 - np.cos(2 * np.pi * z)))),
        Function("ackley", 32.0, 0.0, _ackley),
        Function("griewank", 600.0, 0.0, _griewank),
        Function("levy", 10.0, 1.0, _levy),
        Function("schwefel226", 500.0, 420.968746359982, _schwefel226),
    )
}
