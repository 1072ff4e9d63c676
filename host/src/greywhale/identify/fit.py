"""Least squares from a starting point, with all finite differences of a step simulated as one batch."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from greywhale.base.types import Floats
from greywhale.identify.space import Space

TOLERANCE = 1e-4  # of the least squares, as a share of cost and numbers


def least_squares_fit(
    residual: Callable[[Floats], Floats],
    space: Space,
    start: Floats,
    moves: NDArray[np.bool_],
    most_steps: int,
    step_scale: float,
) -> tuple[Floats, int]:
    """The point of a trust-region fit within the bounds, and how many simulations it took.

    It ends after `most_steps` steps, or when a step gains little. `moves` (numbers of the residual, searched numbers)
    says what changes what; other derivatives are taken as 0, so that several numbers can be varied in one simulation.
    """
    from scipy.optimize import least_squares  # slow to import, and a dashboard needs the models alone

    low, high = space.bounds()
    inside = np.clip(start, low + 1e-9, high - 1e-9)
    steps = space.steps * step_scale
    groups = space.groups()
    known: dict[bytes, Floats] = {}
    simulations = 0

    def values(x: Floats) -> Floats:
        nonlocal simulations
        key = x.tobytes()
        if key not in known:
            known.clear()
            simulations += 1
            known[key] = residual(x[None])[0]
        return known[key]

    def derivatives(x: Floats) -> Floats:
        nonlocal simulations
        ahead = np.where(x + steps > high, -steps, steps)
        points = np.tile(x, (len(groups), 1))
        for row, group in enumerate(groups):
            points[row, group] += ahead[group]
        simulations += len(groups)
        moved = residual(points) - values(x)[None, :]
        jacobian = np.empty((moved.shape[1], len(x)))
        for row, group in enumerate(groups):
            jacobian[:, group] = moved[row][:, None] / ahead[group]
        return jacobian * moves

    kinds = [space.kind(index) for index in range(len(space))]
    # The matrices are tall and narrow. Several BLAS threads would only wait for each other and for the simulations.
    with threadpool_limits(limits=1, user_api="blas"):
        found = least_squares(
            values,
            inside,
            derivatives,
            bounds=(low, high),
            x_scale=np.array([1.0 if kind.logarithmic else 50.0 * kind.step for kind in kinds]),
            max_nfev=most_steps,
            ftol=TOLERANCE,
            xtol=TOLERANCE,
            gtol=1e-8,
        )
    return found.x, simulations
