"""Joints that knock about in the gaps of their gears: which they may be, and the short windows that show their gears.

Chance soon decides where such a joint is. Over the usual windows stiff teeth with less gap then err less than the true
gear.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greywhale.base.types import Flags
from greywhale.identify.candidate import Candidate
from greywhale.identify.data import Prepared
from greywhale.identify.soft_teeth import with_swing
from greywhale.identify.space import COUPLED, GEAR, Space
from greywhale.identify.windows import WindowResidual

# Gears of joints that move freely in a wide gap. Knocks of the first last some milliseconds. The other one's teeth are
# so soft that a knock is slow, too.
FREE = {"gap": 8e-3, "drag": 0.01}
FREE_HZ = 60.0
SOFT = {"gap": 6e-3, "drag": 0.01, "teeth": 0.1}


def turns_of(windows: WindowResidual, space: Space, knocking: Sequence[int]) -> list[tuple[WindowResidual, Flags]]:
    """Windows, and marks on the searched numbers (numbers,) that are fitted to them, one after the other: gears of
    `knocking` joints to short windows, the rest to these.
    """
    short = np.array([one.kind in GEAR and one.joint in knocking for one in space.parameters])
    return [(windows.brief, short), (windows, ~short)] if short.any() else [(windows, ~short)]


def knocking_joints(windows: WindowResidual, found: Candidate) -> tuple[int, ...]:
    """Joints that the windows miss as if they knocked about in their gaps, and those that feel these."""
    errors = windows.settled_error(found.plant, found.zero)
    most = windows.limits.search.knocking
    missed = {joint for joint, error in zip(windows.joints, errors, strict=True) if error > most}
    return tuple(one for coupled in COUPLED if missed & set(coupled) for one in coupled if one in windows.joints)


def knocking_starts(
    found: Candidate, knocking: tuple[int, ...], others: Sequence[Candidate], logs: Sequence[Prepared]
) -> list[Candidate]:
    """Starts of fits with `knocking` joints: the model with its own numbers on them, with free gears, and with
    those of other models.
    """
    mine = np.array([one.joint in knocking for one in found.space.parameters])
    free = with_swing(found.with_values(FREE), logs, FREE_HZ)
    starts = [found, free, found.with_values(SOFT), *others]
    return [replace(found, x=np.where(mine, one.x, found.x), knocking=knocking) for one in starts]


def with_better_gears(usual: Candidate, brief: Candidate, held_out: WindowResidual) -> Candidate:
    """The `usual` fit with the joints of the `brief` one that short windows, held out, show better with it."""
    errors = np.array([held_out.brief.settled_error(one.plant, one.zero) for one in (usual, brief)])
    errors[0] -= held_out.limits.search.knocking_gain
    x = usual.space.mix([usual.x, brief.x], errors, held_out.joints)
    changed = {one.joint for one, old, new in zip(usual.space.parameters, usual.x, x, strict=True) if old != new}
    return replace(usual, x=x, knocking=tuple(joint for joint in brief.knocking if joint in changed))
