"""The uncertainty of each parameter, the numbers that the logs leave open, and the motion that would settle them.

The covariance comes from the sandwich formula with the windows as clusters. A model's mistakes last for many readings
in a row. If each reading counted as new evidence, every deviation would be far too small. The deviations that people
read also hold the doubt about the arm file's masses and lengths. The covariance does not: arms that are drawn from it
have the arm file's links.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.arm.plants import plant_row
from greywhale.base.types import Floats
from greywhale.identify.knocking import turns_of
from greywhale.identify.limits import IDENTIFICATION_LIMITS, UncertaintyLimits
from greywhale.identify.space import KINDS, WHOLE_ARM, Parameter, Space
from greywhale.identify.windows import WindowResidual

# Beyond this condition number the smallest eigenvalue is rounding.
LARGEST_CONDITION = 1e13

EXCITATION = {
    "alpha": "swing a known weight, or hold poses in which gravity pulls differently; without either, torque per volt "
    "cannot be told from inertia and speed, and only their ratios matter",
    "inertia": "reverse the motion quickly, several times a second",
    "damping": "move at a steady speed over a wide range, at several speeds",
    "coulomb": "move slowly to and fro, starting and stopping often",
    "breakaway": "start from rest slowly, many times",
    "stribeck": "move very slowly, at 0.02 to 0.2 rad/s",
    "gap": "reverse slowly and often without load, so that the teeth change sides",
    "drag": "reverse a light joint quickly, so that its link crosses the gap alone",
    "teeth": "reverse with full voltage, so that the teeth bend",
    "ringing": "stop quickly from full speed, and rest",
    "play": "reverse slowly and often, under load too",
    "load": "move a heavy pose slowly up and down",
    "creep": "rest in poses that the motor must hold",
    "lag": "reverse the motion quickly, several times a second",
    "lost": "brake quickly, and reverse slowly in poses without load",
    "uneven": "reverse slowly in poses in which the motor must push up, and in others in which it must push down",
    "sag": "move several joints at full voltage at once",
    "tip": "move the pitch joints through a wide range of poses",
    "offset": "turn the joint through a wide range of poses, so that gravity changes sign",
}


@dataclass(frozen=True)
class Uncertainty:
    """Covariance of the searched numbers, what only people read besides (masses, lengths, arms that differ from any
    model), condition number of the information, sentences on what is open.
    """

    covariance: Floats
    besides: Floats  # a covariance, too
    condition: float
    open: tuple[str, ...]
    limits: UncertaintyLimits = IDENTIFICATION_LIMITS.uncertainty

    @property
    def deviations(self) -> Floats:
        """Standard deviations of the searched numbers."""
        return np.sqrt(np.diag(self.whole))

    @property
    def whole(self) -> Floats:
        """The covariance with all doubts."""
        return self.covariance + self.besides

    def widened(self, covariance: Floats, space: Space, x: Floats, joints: Sequence[int]) -> Uncertainty:
        """Return the uncertainty with another covariance."""
        wider = replace(self, covariance=covariance)
        return replace(wider, open=tuple(_describe_open(space, x, wider.deviations, joints, self.limits)))


def uncertainty(
    windows: WindowResidual,
    space: Space,
    x: Floats,
    joints: Sequence[int],
    knocking: Sequence[int] = (),
    to_read: bool = False,
) -> Uncertainty:
    """Evaluate at a found point. Numbers that the readings leave open are as uncertain as the user's arm file.

    Gears of `knocking` joints were fitted to short windows. `to_read`: people read the deviations; else masses and
    lengths need not be looked at.
    """
    # Wide differences: a joint that hunts makes the residual rough, and roughness is no information.
    residual, limits = _AllWindows(windows, space, knocking), windows.limits.uncertainty
    steps = limits.wide_difference * space.doubts()
    _, high = space.bounds()
    ahead = np.where(x + steps > high, -steps, steps)
    numbers = residual(space, np.vstack([x[None], x[None, :] + np.diag(ahead)]))
    jacobian = ((numbers[1:] - numbers[0]) / ahead[:, None]).T
    fitted = np.where(residual.fitted, jacobian, 0.0)
    information, slopes = fitted.T @ fitted, fitted.T @ jacobian
    # Each number in its own natural size: a factor of e, or a step that makes it another value of the quantity.
    natural = dict(limits.open_steps)
    size = np.array([1.0 if space.kind(n).logarithmic else natural[one.kind] for n, one in enumerate(space.parameters)])
    values = np.linalg.eigvalsh(information * np.outer(size, size))
    known = float(values[0]) * LARGEST_CONDITION > float(values[-1])
    condition = float(values[-1]) / float(values[0]) if known else LARGEST_CONDITION
    gradients = np.zeros((residual.clusters.max() + 1, len(space)))
    np.add.at(gradients, residual.clusters, fitted * numbers[0][:, None])
    covariance = combine_sources(information, gradients.T @ gradients, slopes, np.diag(space.doubts_at(x) ** -2.0))
    besides = np.zeros_like(covariance)
    if to_read:
        fit = np.linalg.inv(slopes + np.diag(space.doubts() ** -2.0)) @ fitted.T
        others = [replace(space, arm=arm, base=plant_row(arm)) for arm in _with_other_links(space.arm, limits)]
        # Where a fit with other masses and lengths would end.
        moved = np.array([fit @ (residual(other, x[None])[0] - numbers[0]) for other in others])
        besides = moved.T @ moved
        besides += np.diag(_foreign(space, x, limits))
    found = _describe_open(space, x, np.sqrt(np.diag(covariance + besides)), joints, limits)
    return Uncertainty(covariance, besides, condition, tuple(found), limits)


class _AllWindows:
    """Windows, and the short ones that gears of `knocking` joints are fitted to, in one residual."""

    def __init__(self, windows: WindowResidual, space: Space, knocking: Sequence[int]) -> None:
        turns = turns_of(windows, space, knocking)
        self._seen = [seen for seen, _ in turns]
        # (numbers of the residual, searched numbers): true where the one is fitted to the other.
        self.fitted = np.repeat([own for _, own in turns], [len(seen.clusters) for seen in self._seen], axis=0)
        before = np.cumsum([0, *(seen.windows for seen in self._seen)])
        self.clusters = np.concatenate([first + seen.clusters for first, seen in zip(before, self._seen, strict=False)])

    def __call__(self, space: Space, points: Floats) -> Floats:
        return np.concatenate([seen(space, points) for seen in self._seen], axis=1)


def _foreign(space: Space, x: Floats, limits: UncertaintyLimits) -> Floats:
    """Return the variances by which fits of arms that no model is like are off besides, in the searched numbers."""
    known, foreign, creeping = dict(zip(space.names, x, strict=True)), dict(limits.foreign), dict(limits.creeping)
    found = np.zeros(len(x))
    for index, one in enumerate(space.parameters):
        usual = foreign.get(one.kind, 0.0)
        if one.kind == "gap" and f"joint{one.joint}.play" in known:
            usual = limits.gap_beside_play_rad
        found[index] = usual**2 + (creeping.get(one.kind, 0.0) * known.get(f"joint{one.joint}.creep", 0.0)) ** 2
    return found


def _with_other_links(arm: ArmParameters, limits: UncertaintyLimits) -> list[ArmParameters]:
    """The arm with one mass, or one length, off by a standard deviation of numbers that are anywhere in their range."""
    heavier, longer = (1.0 + share / np.sqrt(3.0) for share in (limits.mass_share, limits.length_share))
    arms = []
    for number, link in enumerate(arm.link):
        for mass, length in ((heavier, 1.0), (1.0, longer)):
            inertia = {key: mass * length**2 * value for key, value in link.inertia.model_dump().items()}
            sizes = {"mass": mass * link.mass, "length": length * link.length, "centre": length * link.centre}
            other = link.model_copy(update={**sizes, "inertia": link.inertia.model_copy(update=inertia)})
            arms.append(arm.model_copy(update={"link": (*arm.link[:number], other, *arm.link[number + 1 :])}))
    return arms


def combine_sources(information: Floats, scatter: Floats, slopes: Floats, nominal: Floats) -> Floats:
    """The covariance from three sources.

    `information` is what the readings would tell if only noise were in them. `scatter`, of the clusters' gradients, is
    how much they disagree beyond that. `nominal` is the user's arm file, as information. With the `slopes` of the
    gradients the readings tell slopes x scatter^-1 x slopes (Godambe). Few clusters show the scatter badly, so it is
    drawn half way towards the information times one common factor. Numbers, and sums of numbers, that the readings
    leave open stay as uncertain as in the arm file.
    """
    inverse = np.linalg.inv(information + nominal)
    common = float(np.trace(inverse @ scatter) / np.trace(inverse @ information))
    # In units of the arm file's doubts. Readings that show only the sum of two numbers leave a matrix without inverse.
    units = np.outer(doubts := np.diag(nominal) ** -0.5, doubts)
    drawn, shown = (scatter + common * information) / 2.0 * units, slopes * units
    told = shown.T @ np.linalg.pinv(drawn, rcond=1.0 / LARGEST_CONDITION, hermitian=True) @ shown
    # By its eigenvalues, so that rounding leaves no variance below 0.
    values, vectors = np.linalg.eigh((told + told.T) / 2.0)
    covariance: Floats = vectors / (1.0 + np.maximum(values, 0.0)) @ vectors.T * units
    return (covariance + covariance.T) / 2.0


def whose(parameter: Parameter) -> str:
    """The joint's number and name, or the arm."""
    if parameter.joint == WHOLE_ARM:
        return "the arm"
    return f"joint {parameter.joint} ({JOINT_NAMES[parameter.joint]})"


def open_beyond(parameter: Parameter, limits: UncertaintyLimits = IDENTIFICATION_LIMITS.uncertainty) -> float:
    """The largest standard deviation with which a searched number counts as known."""
    kind = parameter.kind
    if KINDS[kind].logarithmic:
        return dict(limits.open_factors).get(kind, limits.open_log)
    return dict(limits.open_steps)[kind]


def _describe_open(
    space: Space, x: Floats, deviations: Floats, joints: Sequence[int], limits: UncertaintyLimits
) -> list[str]:
    sentences = [
        f"joint {joint} ({JOINT_NAMES[joint]}): its motor did not move it, so nothing of it was identified and the "
        "values of the arm file stay; lead it by half a radian or more"
        for joint in space.arm.joints_in_use
        if joint not in joints
    ]
    for index, parameter in enumerate(space.parameters):
        kind = KINDS[parameter.kind]
        if deviations[index] <= open_beyond(parameter, limits):
            continue
        known = (
            f"known to a factor of {np.exp(min(deviations[index], 7.0)):.2g} only"
            if kind.logarithmic
            else f"{x[index]:.2g} +- {deviations[index]:.2g} {kind.unit}".rstrip()
        )
        sentences.append(
            f"{whose(parameter)}: {parameter.kind}, the {kind.means}, is {known}; {EXCITATION[parameter.kind]}"
        )
    return sentences
