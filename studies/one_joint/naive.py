"""What physics must beat: linear lags with dead time from leader to follower, fitted as well as they can be.

First order: y' = (K r(t - L) + b - y) / T. Second order: y'' = w² (K r(t - L) + b - y) - 2 z w y'. They know nothing of
the controller, so it is part of what they fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import cont2discrete, lfilter, lfiltic
from threadpoolctl import threadpool_limits

from greywhale.base.types import Floats
from studies.one_joint.record import Record

GRID_S = 1e-3
DEAD_TIMES = (0.002, 0.03, 0.1)  # s, where least squares starts from
LAGS = (0.02, 0.1, 0.5)  # s, likewise
LONGEST_DEAD_TIME = 0.5


@dataclass(frozen=True)
class Lag:
    """A fitted lag: gain, offset (rad), dead time (s), and the time constant (s), or frequency (rad/s) and damping."""

    order: int
    gain: float
    offset: float
    dead_time: float
    shape: tuple[float, ...]

    def follow(self, record: Record) -> Floats:
        """The follower along a whole record, led by its leader, from where the record starts; rad."""
        return _respond(record, self)


def fit_lag(records: Sequence[Record], order: int) -> Lag:
    """The lag of order 1 or 2 with the least squared error over the records, by least squares from many starts."""

    def errors(x: Floats) -> Floats:
        lag = _lag(order, x)
        return np.concatenate([(_respond(one, lag) - one.follower)[:: _every(one)] for one in records])

    low, high = _bounds(order)
    # The matrices are tall and narrow: BLAS threads would only wait for each other.
    with threadpool_limits(limits=1, user_api="blas"):
        fits = [
            least_squares(errors, start, bounds=(low, high), x_scale="jac", diff_step=1e-3, max_nfev=60)
            for start in _starts(order)
        ]
    return _lag(order, min(fits, key=lambda one: one.cost).x)


def _every(record: Record) -> int:
    return max(1, round(5e-3 / float(np.median(record.spacing))))


def _lag(order: int, x: Floats) -> Lag:
    return Lag(order, float(x[0]), float(x[1]), float(x[2]), tuple(float(one) for one in np.exp(x[3:])))


def _bounds(order: int) -> tuple[Floats, Floats]:
    shape = (
        [(np.log(1e-3), np.log(30.0))] if order == 1 else [(np.log(0.1), np.log(500.0)), (np.log(0.02), np.log(30.0))]
    )
    pairs = [(-3.0, 3.0), (-1.0, 1.0), (0.0, LONGEST_DEAD_TIME), *shape]
    return np.array([pair[0] for pair in pairs]), np.array([pair[1] for pair in pairs])


def _starts(order: int) -> list[Floats]:
    shapes = [(np.log(lag),) if order == 1 else (-np.log(lag), np.log(ratio)) for lag in LAGS for ratio in (0.3, 1.0)]
    unique = dict.fromkeys(shapes)
    return [np.array([0.9, 0.01, dead, *shape]) for dead in DEAD_TIMES for shape in unique]


def _respond(record: Record, lag: Lag) -> Floats:
    """On a grid of 1 ms with the input held over a step, so that each step is exact; moved by the dead time at the end,
    so that the answer changes smoothly with it."""
    time = np.arange(record.time[0], record.time[-1] + GRID_S, GRID_S)
    led = lag.gain * _leader(record, time) + lag.offset
    if lag.order == 1:
        top, bottom = [1.0], [lag.shape[0], 1.0]
    else:
        omega, damping = lag.shape
        top, bottom = [omega**2], [1.0, 2.0 * damping * omega, omega**2]
    b, a, _ = cont2discrete((top, bottom), GRID_S, method="zoh")
    b = b.ravel()
    # At rest at the first angle: the past is as if the leader had asked for just that.
    first = record.follower[0]
    past = [first] * lag.order
    state = lfiltic(b, a, past, past)
    angles, _ = lfilter(b, a, led, zi=state)
    followed: Floats = np.interp(record.time - lag.dead_time, time, angles, left=first)
    return followed


def _leader(record: Record, moments: Floats) -> Floats:
    if record.leader_lines:
        led: Floats = np.interp(moments, record.time, record.leader)
        return led
    rows = np.clip(np.searchsorted(record.time, moments, side="right") - 1, 0, len(record.time) - 1)
    return record.leader[rows]
