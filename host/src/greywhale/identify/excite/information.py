"""The information in a motion about every parameter: the Fisher information of the residual that identification fits.

The identification drives candidates by the logged voltages over windows of half a second. Each window starts where the
log says, and angles are compared. To first order, a wrong parameter acts on a joint like a voltage (the voltage that
the parameter's own term takes), and that voltage moves the joint as its motor does. The part that a wrong start angle
and speed could explain is removed. Each joint is treated alone: the effect of a wrong parameter on its neighbours is
left out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greywhale.arm.body import Body
from greywhale.arm.limits import GUESSES
from greywhale.arm.parameters import USUAL_TRACK_RAD
from greywhale.arm.plants import column
from greywhale.base.types import Floats
from greywhale.identify.limits import IDENTIFICATION_LIMITS, IdentificationLimits
from greywhale.identify.space import KINDS, Parameter
from greywhale.protocol.firmware import CONVERSIONS, JOINTS

# A reading's standard deviation (rad).
NOISE_RAD = GUESSES.noise_v / 5.0 * USUAL_TRACK_RAD / math.sqrt(CONVERSIONS)
_STEP = 1e-3  # rad, for the derivative by a zero angle


def information(
    plant: Floats,
    angles: Floats,
    row_s: float,
    parameters: Sequence[Parameter],
    judging: IdentificationLimits = IDENTIFICATION_LIMITS,
) -> Floats:
    """Work out what a follower's motion shows about `parameters`, joint by joint, (n, n) over the searched numbers.

    The motion is angles (rows, 4) rad every `row_s` seconds, on a plant (columns,).
    """
    velocity = np.gradient(angles, row_s, axis=0)
    acceleration = np.gradient(velocity, row_s, axis=0)
    body = Body.of(plant)
    torque = body.torque(angles, velocity, acceleration)
    inertia = np.diagonal(body.mass_matrix(angles), axis1=1, axis2=2).mean(axis=0)
    rows = round(judging.data.window_s / row_s)
    matrix = np.zeros((len(parameters), len(parameters)))
    for joint in range(JOINTS):
        here = [index for index, one in enumerate(parameters) if one.joint == joint]
        if not here:
            continue
        motion = _Motion(body, plant, joint, angles, velocity, acceleration[:, joint], torque[:, joint], judging)
        volts = np.column_stack([motion.volts(parameters[index].kind) for index in here])
        shift = np.column_stack([motion.shift(parameters[index].kind) for index in here])
        push = _response(plant, joint, float(inertia[joint]), rows, row_s)
        seen = push @ _windows(volts, rows) + _windows(shift, rows)
        left = _without_start(plant, joint, float(inertia[joint]), rows, row_s, judging)
        matrix[np.ix_(here, here)] = (seen.transpose(0, 2, 1) @ (left @ seen)).sum(axis=0)
    return matrix


@dataclass(frozen=True)
class _Motion:
    """One joint's motion, and the voltage that each parameter takes in it."""

    body: Body
    plant: Floats
    joint: int
    q: Floats
    v: Floats
    a: Floats
    torque: Floats
    judging: IdentificationLimits

    def volts(self, kind: str) -> Floats:
        """(rows,) V by which a unit of the searched number changes the voltage that the motion takes."""
        alpha, speed = 1.0 / self._of("torque_per_volt"), self.v[:, self.joint]
        sliding: Floats = np.tanh(speed / self.judging.excitation.still_rad_s)
        coulomb = alpha * self._of("coulomb")
        excess = max(alpha * self._of("breakaway") - coulomb, 0.0)
        ratio: Floats = (speed / self._of("stribeck_velocity")) ** 2
        match kind:
            case "alpha":
                return alpha * self.torque
            case "inertia":
                return alpha * self._of("inertia") * self.a
            case "damping":
                return alpha * self._of("damping") * speed
            case "coulomb":
                return coulomb * sliding
            case "breakaway":
                return coulomb * sliding / (1.0 + ratio)
            case "stribeck":
                return excess * sliding * 2.0 * ratio / (1.0 + ratio) ** 2
            case "offset":
                moved = self.q.copy()
                moved[:, self.joint] += _STEP
                still = np.zeros_like(self.q)
                change = self.body.bias(moved, still) - self.body.bias(self.q, still)
                return alpha * change[:, self.joint] / _STEP
            case _:  # gap and teeth move the joint without a voltage; drag acts inside the gap only, and hardly shows
                return np.zeros(len(speed))

    def _of(self, name: str) -> float:
        return float(self.plant[column(name, self.joint)])

    def shift(self, kind: str) -> Floats:
        """(rows,) by which a unit of the searched number moves the joint against its motor: backlash, bending teeth."""
        stiffness = self._of("stiffness")
        if kind == "teeth" and stiffness > 0.0:
            return -self.torque / stiffness
        if kind != "gap":
            return np.zeros(len(self.a))
        return np.tanh(self.torque / max(1e-3, 0.02 * float(np.abs(self.torque).max())))


def _windows(values: Floats, rows: int) -> Floats:
    """(windows, rows, columns)"""
    count = len(values) // rows
    return values[: count * rows].reshape(count, rows, values.shape[1])


def _lag(plant: Floats, joint: int, inertia: float) -> float:
    """Time constant of the joint's speed under a voltage, s."""
    whole = float(plant[column("inertia", joint)]) + inertia
    return whole / float(plant[column("damping", joint)])


def _response(plant: Floats, joint: int, inertia: float, rows: int, row_s: float) -> Floats:
    """(rows, rows): angle in each row of a window per volt in each row before."""
    lag = _lag(plant, joint, inertia)
    gain = float(plant[column("torque_per_volt", joint)]) / float(plant[column("damping", joint)])
    time_s = np.arange(rows) * row_s
    since = time_s[:, None] - time_s[None, :]
    pulse = gain * row_s * -np.expm1(-np.maximum(since, 0.0) / lag)
    return np.where(since > 0.0, pulse, 0.0)


def _without_start(
    plant: Floats, joint: int, inertia: float, rows: int, row_s: float, judging: IdentificationLimits
) -> Floats:
    """(rows, rows): the information of readings in a window whose start angle and speed are known poorly."""
    lag = _lag(plant, joint, inertia)
    time_s = np.arange(rows) * row_s
    basis = np.column_stack([np.ones(rows), lag * -np.expm1(-time_s / lag)])
    doubt = np.diag([NOISE_RAD**-2.0, judging.windows.speed_doubt_rad_s**-2.0])
    # The identification compares every 5 ms; fewer rows here stand for those.
    weight = row_s / 5e-3 / NOISE_RAD**2
    normal = weight * basis.T @ basis + doubt
    return weight * (np.eye(rows) - weight * basis @ np.linalg.solve(normal, basis.T))


def prior(parameters: Sequence[Parameter], covariance: Floats, doubts: Floats) -> Floats:
    """The information that is known before: a model's covariance, and the `doubts` (deviations) of an arm file."""
    known = np.zeros_like(covariance)
    for joint in range(JOINTS):
        here = [index for index, one in enumerate(parameters) if one.joint == joint]
        block = np.ix_(here, here)
        known[block] = np.linalg.inv(covariance[block] + 1e-12 * np.eye(len(here)))
    return known + np.diag(doubts**-2.0)


def natural_sizes(parameters: Sequence[Parameter]) -> Floats:
    """The size that counts as one in each searched number: a factor of e, or ten steps of finite differences."""
    return np.array([1.0 if KINDS[one.kind].logarithmic else 10.0 * KINDS[one.kind].step for one in parameters])
