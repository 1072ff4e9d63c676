"""How well the logs determine each parameter, what they leave open, and which motion would settle it.

Standard deviations come from the sandwich formula with the windows as clusters: what a model gets wrong it gets wrong
for many readings in a row, and counting each of them as new evidence would make every deviation far too small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.identify.space import JOINTS, KINDS, Space
from greywhale.identify.windows import WindowResidual

Floats = NDArray[np.float64]
# A positive quantity known no better than to this factor's logarithm (or any other to this many steps) is left open.
OPEN_LOG = 0.3
OPEN = {"breakaway": 0.5, "gap": 2e-3, "offset": 0.05}
# Directions of the search space below this share of the largest eigenvalue are not used to invert.
SMALLEST_EIGENVALUE = 1e-13

EXCITATION = {
    "alpha": "swing a known weight, or hold poses in which gravity pulls differently; without either, torque per volt "
    "cannot be told from inertia and speed, and only their ratios matter",
    "inertia": "reverse the motion quickly, several times a second",
    "damping": "move at a steady speed over a wide range, at several speeds",
    "coulomb": "move slowly to and fro, starting and stopping often",
    "breakaway": "start from rest slowly, many times",
    "stribeck": "move very slowly, at 0.02 to 0.2 rad/s",
    "gap": "reverse slowly and often without load, so that the teeth change sides",
    "offset": "turn the joint through a wide range of poses, so that gravity changes sign",
}


@dataclass(frozen=True)
class Uncertainty:
    """Standard deviations of the searched numbers, condition number of the information, sentences on what is open."""

    deviations: Floats
    condition: float
    open: tuple[str, ...]


def uncertainty(residual: WindowResidual, space: Space, x: Floats, joints: Sequence[int]) -> Uncertainty:
    """Evaluate at a found point."""
    steps = space.steps * 2.0
    _, high = space.bounds()
    ahead = np.where(x + steps > high, -steps, steps)
    numbers = residual(space, np.vstack([x[None], x[None, :] + np.diag(ahead)]))
    jacobian = ((numbers[1:] - numbers[0]) / ahead[:, None]).T
    information = jacobian.T @ jacobian
    # Each number in its own natural size: a factor of e, or what would be called another value of the quantity.
    size = np.array([1.0 if space.kind(n).logarithmic else OPEN[one.kind] for n, one in enumerate(space.parameters)])
    values, vectors = np.linalg.eigh(information * np.outer(size, size))
    least = max(float(values[0]), SMALLEST_EIGENVALUE * float(values[-1]))
    condition = float(values[-1]) / least
    inverse = (vectors / np.maximum(values, least)) @ vectors.T * np.outer(size, size)
    gradients = np.zeros((residual.clusters.max() + 1, len(space)))
    np.add.at(gradients, residual.clusters, jacobian * numbers[0][:, None])
    covariance = inverse @ (gradients.T @ gradients) @ inverse
    deviations: Floats = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return Uncertainty(deviations, condition, tuple(_open(space, x, deviations, joints)))


def _open(space: Space, x: Floats, deviations: Floats, joints: Sequence[int]) -> list[str]:
    sentences = [
        f"joint {joint} ({JOINT_NAMES[joint]}): it did not move, so nothing of it was identified and the values of the "
        "arm file stay; move it by half a radian or more"
        for joint in range(JOINTS)
        if joint not in joints
    ]
    for index, parameter in enumerate(space.parameters):
        kind = KINDS[parameter.kind]
        if deviations[index] <= (OPEN_LOG if kind.logarithmic else OPEN[parameter.kind]):
            continue
        known = (
            f"known to a factor of {np.exp(min(deviations[index], 7.0)):.2g} only"
            if kind.logarithmic
            else f"{x[index]:.2g} +- {deviations[index]:.2g} {kind.unit}".rstrip()
        )
        sentences.append(
            f"joint {parameter.joint} ({JOINT_NAMES[parameter.joint]}): {parameter.kind}, the {kind.means}, "
            f"is {known}; "
            f"{EXCITATION[parameter.kind]}"
        )
    return sentences
