"""From sweeps and held poses to zero, scale and limits, as the board stores them.

angle = scale x (count14 - zero), count14 = 16 counts (docs/link.md). The sweeps give the sign of each scale, a pose
with known angles gives the zeros. The size of the scales comes from a second known pose, or from the tracks' length.
Two arms held in the same pose must agree: what counts is that the follower does as the leader, not a degree of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from greywhale.base.errors import BadUsage, UserError
from greywhale.base.types import Flags, Floats
from greywhale.board.calibrate.rules import ask, words
from greywhale.board.calibrate.sweep import Sweep
from greywhale.board.pots import COUNT14_PER_COUNT, POTS
from greywhale.protocol import schema
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import ALL, Joints


@dataclass(frozen=True)
class Pose:
    """Both arms held still: `angles` (4,) rad, the same for both arms, and `counts` (8,)."""

    angles: Floats
    counts: Floats


@dataclass(frozen=True)
class Calibration:
    """`zero` (8,) counts, `scale` (8,) rad a count, `limits` (4, 2) rad; columns leader 0..3, follower 0..3.

    What it says of joints that are not in use means nothing.
    """

    zero: Floats
    scale: Floats
    limits: Floats
    joints: Joints = ALL

    @property
    def pots(self) -> tuple[int, ...]:
        return tuple(pot for pot in range(len(POTS)) if pot % JOINTS in self.joints)

    def changes(self) -> dict[str, int]:
        """Raw values by parameter name; a joint that is not in use gets a scale of 0 at both arms. Raises UserError
        where a value does not fit.
        """
        values: dict[str, float] = {}
        for pot, name in enumerate(POTS):
            if pot in self.pots:
                values[f"{name}.zero"] = COUNT14_PER_COUNT * self.zero[pot]
            values[f"{name}.scale"] = self.scale[pot] / COUNT14_PER_COUNT if pot in self.pots else 0.0
        for joint in self.joints:
            values[f"joint{joint}.limit_min"], values[f"joint{joint}.limit_max"] = self.limits[joint]
        return {name: _raw(name, value) for name, value in values.items()}


def solve(sweeps: Sequence[Sweep], first: Pose, second: Pose | None, track_rad: float | None) -> Calibration:
    """The calibration from a sweep of every potentiometer, a known pose, and a second known pose or the tracks' length.

    The joints that were swept are those in use. Raises UserError where sweeps and poses contradict each other.
    """
    joints = tuple(sorted({sweep.pot % JOINTS for sweep in sweeps}))
    if second is not None:
        require_apart(first.angles, second.angles, joints)
    elif track_rad is None:
        raise UserError("neither a second pose nor the tracks' length is known; give one of them.")
    known: list[ArrayLike] = [track_rad or 0.0] if second is None else [second.angles, second.counts]
    return _calibration("solve", sweeps, joints, first.angles, first.counts, *known)


def match(calibration: Calibration, sweeps: Sequence[Sweep], first: Pose, same: Pose) -> Calibration:
    """Let the follower agree with the leader in a pose whose angles nobody knows; `same.angles` are not used."""
    known = (calibration.zero, calibration.scale, first.angles, first.counts, same.counts)
    return _calibration("match", sweeps, calibration.joints, *known)


def slipped(before: Pose, after: Pose) -> str:
    """A sentence about the potentiometers that read something else where the same pose is held again; "" for none."""
    return words("slipped", before.counts, after.counts)


def require_apart(first: Floats, second: Floats, joints: Sequence[int]) -> None:
    """Refuse two poses (4,), rad, from which no scale can be told."""
    if alike := words("require_apart", first, second, _in_use(joints)):
        raise BadUsage(alike)


def apart(found: Calibration, pose: Pose) -> tuple[Floats, str]:
    """The distance between the arms (4,) rad in a pose from which nothing was worked out; a sentence if that is far."""
    return ask("apart", _in_use(found.joints), found.zero, found.scale, pose.counts)


def _calibration(rule: str, sweeps: Sequence[Sweep], joints: Joints, *known: ArrayLike) -> Calibration:
    """Zeros, scales and limits of a rule. Raises UserError where it has none."""
    columns = np.tile([[1.0], [0.0], [0.0]], len(POTS))
    for sweep in sweeps:
        columns[:, sweep.pot] = sweep.direction, sweep.low, sweep.high
    numbers, mistake = ask(rule, _in_use(joints), columns, *known)
    if mistake:
        raise UserError(mistake)
    zero, scale, limits = np.split(numbers, [len(POTS), 2 * len(POTS)])
    return Calibration(zero, scale, limits.reshape(JOINTS, 2), joints)


def _in_use(joints: Sequence[int]) -> Flags:
    return np.isin(np.arange(JOINTS), joints)


def _raw(name: str, value: float) -> int:
    parameter = schema.PARAMETER_BY_NAME[name]
    kept_within = name.endswith(("limit_min", "limit_max"))
    numbers, mistake = ask("raw", value, parameter.minimum, parameter.maximum, parameter.lsb, kept_within)
    if mistake:
        raise UserError(f"{name} {mistake}")
    return int(numbers[0])
