"""Least squares from a starting point, with all finite differences of a step simulated as one batch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from threadpoolctl import threadpool_limits

from greywhale.base.types import Floats
from greywhale.identify.space import Kind


class Searched(Protocol):
    """Anything that has numbers to search: how many, in which bounds, with which steps of finite differences."""

    def __len__(self) -> int: ...

    def bounds(self) -> tuple[Floats, Floats]: ...

    @property
    def steps(self) -> Floats: ...

    def kind(self, index: int) -> Kind: ...


Space = TypeVar("Space", bound=Searched)
Residual = Callable[[Space, Floats], Floats]


@dataclass(frozen=True)
class Pattern:
    """Which searched numbers change which numbers of a residual, so that several can be varied in one simulation."""

    groups: tuple[NDArray[np.intp], ...]  # searched numbers that are varied together
    moves: NDArray[np.bool_]  # (numbers of the residual, searched numbers)


@dataclass(frozen=True)
class Fit(Generic[Space]):
    """The end of a least-squares fit: half the sum of squares, and the residual and its derivatives there."""

    space: Space
    x: Floats
    cost: float
    residual: Floats
    jacobian: Floats
    simulations: int


def least_squares_fit(
    residual: Residual[Space],
    space: Space,
    start: Floats,
    most_steps: int = 20,
    step_scale: float = 1.0,
    tolerance: float = 1e-4,
    pattern: Pattern | None = None,
) -> Fit[Space]:
    """Trust-region least squares within the bounds. It ends after `most_steps` steps, or when a step gains little.

    With a `pattern`, derivatives outside of it are taken as 0.
    """
    low, high = space.bounds()
    inside = np.clip(start, low + 1e-9, high - 1e-9)
    steps = space.steps * step_scale
    known: dict[bytes, Floats] = {}
    simulations = 0

    def values(x: Floats) -> Floats:
        nonlocal simulations
        key = x.tobytes()
        if key not in known:
            known.clear()
            simulations += 1
            known[key] = residual(space, x[None])[0]
        return known[key]

    groups = pattern.groups if pattern else tuple(np.array([index]) for index in range(len(space)))

    def derivatives(x: Floats) -> Floats:
        nonlocal simulations
        ahead = np.where(x + steps > high, -steps, steps)
        points = np.tile(x, (len(groups), 1))
        for row, group in enumerate(groups):
            points[row, group] += ahead[group]
        simulations += len(groups)
        moved = residual(space, points) - values(x)[None, :]
        jacobian = np.empty((moved.shape[1], len(x)))
        for row, group in enumerate(groups):
            jacobian[:, group] = moved[row][:, None] / ahead[group]
        if pattern:
            jacobian *= pattern.moves
        return jacobian

    scale = np.array(
        [1.0 if space.kind(index).logarithmic else 50.0 * space.kind(index).step for index in range(len(space))]
    )
    # The matrices are tall and narrow. Several BLAS threads would only wait for each other and for the simulations.
    with threadpool_limits(limits=1, user_api="blas"):
        found = least_squares(
            values,
            inside,
            derivatives,
            bounds=(low, high),
            x_scale=scale,
            max_nfev=most_steps,
            ftol=tolerance,
            xtol=tolerance,
            gtol=1e-8,
        )
    return Fit(space, found.x, float(found.cost), found.fun, found.jac, simulations)
