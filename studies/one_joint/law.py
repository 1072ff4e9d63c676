"""Known controllers of foreign rigs: any linear law in discrete time, with saturation, or a relay.

x' = A x + B (leader, follower); u = C x + D (leader, follower), cut to +-limit. With a hysteresis it is a relay:
+-limit beyond +-hysteresis, what it was before within.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greywhale.base.types import Floats


@dataclass(frozen=True)
class Law:
    """V out of rad. `steps_per_row`: how often it runs from one row of the record to the next."""

    a: Floats
    b: Floats
    c: Floats
    d: Floats
    limit: float
    hysteresis: float = 0.0
    steps_per_row: int = 1
    start: tuple[float, ...] | None = None  # state at the record's first row; None: as if it had long read that row

    @property
    def order(self) -> int:
        return len(self.c)

    def states(self, leader: Floats, follower: Floats) -> Floats:
        """The state before each row (rows, order) when the law ran over a record, in straight lines between rows."""
        moments = np.arange(len(leader) * self.steps_per_row) / self.steps_per_row
        rows = np.arange(len(leader))
        signals = np.column_stack([np.interp(moments, rows, signal) for signal in (leader, follower)])
        inputs = signals @ self.b.T
        states = np.zeros((len(moments), self.order))
        x = self._settled(inputs[0]) if self.start is None else np.array(self.start)
        for step, given in enumerate(inputs):
            states[step] = x
            x = self.a @ x + given
        return states[:: self.steps_per_row]

    def _settled(self, given: Floats) -> Floats:
        state: Floats = np.linalg.lstsq(np.eye(self.order) - self.a, given, rcond=None)[0].astype(np.float64)
        return state

    def output(self, leader: Floats, follower: Floats) -> Floats:
        """u for each row of a record, cut to the limit (no relay); V."""
        linear = self.states(leader, follower) @ self.c + np.column_stack([leader, follower]) @ self.d
        u: Floats = np.clip(linear, -self.limit, self.limit)
        return u


def proportional(gain: float, limit: float, steps_per_row: int = 1) -> Law:
    """u = gain (leader - follower), V/rad."""
    none = np.zeros((0, 0))
    return Law(none, np.zeros((0, 2)), np.zeros(0), np.array([gain, -gain]), limit, steps_per_row=steps_per_row)


def relay(limit: float, hysteresis: float, steps_per_row: int = 1) -> Law:
    """+-limit (V) by the side that the error (rad) was last beyond the hysteresis on."""
    none = np.zeros((0, 0))
    d = np.array([1.0, -1.0])
    return Law(none, np.zeros((0, 2)), np.zeros(0), d, limit, hysteresis, steps_per_row)


def proportional_derivative(kp: float, kd: float, limit: float, period: float, steps_per_row: int = 1) -> Law:
    """u = kp e + kd (e - e before) / period; kp in V/rad, kd in V s/rad. The state is the error before."""
    slope = kd / period
    return Law(
        a=np.zeros((1, 1)),
        b=np.array([[1.0, -1.0]]),
        c=np.array([-slope]),
        d=np.array([kp + slope, -kp - slope]),
        limit=limit,
        steps_per_row=steps_per_row,
    )


def trapezoidal_pid(kp: float, ki: float, kd: float, pole: float, period: float, limit: float, integral: float) -> Law:
    """PID whose integral and filtered derivative follow the trapezoidal rule; the integral (V) starts as given.

    State: integral, error before, derivative part before. The integral does not stop at the limit.
    """
    half, keep = 0.5 * ki * period, (2.0 - pole * period) / (2.0 + pole * period)
    rate = 2.0 * pole * kd / (2.0 + pole * period)
    gain = kp + half + rate
    sign = np.array([1.0, -1.0])
    return Law(
        a=np.array([[1.0, half, 0.0], [0.0, 0.0, 0.0], [0.0, -rate, keep]]),
        b=np.outer([half, 1.0, rate], sign),
        c=np.array([1.0, half - rate, keep]),
        d=gain * sign,
        limit=limit,
        start=(integral, 0.0, 0.0),
    )


def proportional_resonant(kp: float, kr: float, omega: float, period: float, limit: float) -> Law:
    """Gain on the error beside a resonator at omega (rad/s), by the trapezoidal rule.

    State: the last two errors and the last two outputs of the resonator. A resonator this slow hangs on the last digits
    of its coefficients, so they are rounded to the single precision that a small board reckons in.
    """
    square = (omega * period) ** 2
    lead = float(np.float32(2.0 * kr * period / (4.0 + square)))
    first = float(np.float32((2.0 * square - 8.0) / (4.0 + square)))
    sign = np.array([1.0, -1.0])
    resonator = np.array([0.0, -lead, -first, -1.0])
    return Law(
        a=np.array([[0, 0, 0, 0], [1, 0, 0, 0], resonator, [0, 0, 1, 0]], dtype=np.float64),
        b=np.outer([1.0, 0.0, lead, 0.0], sign),
        c=resonator,
        d=(kp + lead) * sign,
        limit=limit,
        start=(0.0, 0.0, 0.0, 0.0),
    )
