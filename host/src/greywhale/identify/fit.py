"""Least squares from a starting point, with all finite differences of a step simulated as one batch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from threadpoolctl import threadpool_limits

from greywhale.identify.space import Kind

Floats = NDArray[np.float64]


class Searched(Protocol):
    """Whatever has numbers to search: how many, in which bounds, with which steps of finite differences."""

    def __len__(self) -> int: ...

    def bounds(self) -> tuple[Floats, Floats]: ...

    @property
    def steps(self) -> Floats: ...

    def kind(self, index: int) -> Kind: ...


Space = TypeVar("Space", bound=Searched)
Residual = Callable[[Space, Floats], Floats]


@dataclass(frozen=True)
class Fit(Generic[Space]):
    """Where least squares ended: half the sum of squares, the residual and its derivatives there."""

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
) -> Fit[Space]:
    """Trust-region least squares within the bounds, ended after `most_steps` steps or when little is gained."""
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

    def derivatives(x: Floats) -> Floats:
        nonlocal simulations
        ahead = np.where(x + steps > high, -steps, steps)
        simulations += len(x)
        moved = residual(space, x[None, :] + np.diag(ahead))
        jacobian: Floats = ((moved - values(x)[None, :]) / ahead[:, None]).T
        return jacobian

    scale = np.array(
        [1.0 if space.kind(index).logarithmic else 50.0 * space.kind(index).step for index in range(len(space))]
    )
    # The matrices are tall and narrow: BLAS threads would only wait for each other, and for the simulations' own.
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
