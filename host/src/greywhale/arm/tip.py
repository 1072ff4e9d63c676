"""The place of the arm's tip: the kinematics of docs/arm.md, x ahead, y up, from the base's foot."""

from __future__ import annotations

import numpy as np

from greywhale.arm.parameters import ArmParameters
from greywhale.base.types import Floats


def tip_of(arm: ArmParameters, angles: Floats) -> Floats:
    """(n, 3) m at joint angles (n, 4) rad."""
    base, upper, lower, hand = (link.length for link in arm.link)
    yaw, shoulder, pitch = angles[:, 0], angles[:, 1], angles[:, 1] + angles[:, 2]
    out = upper * np.cos(shoulder) + (lower + hand) * np.cos(pitch)
    up = base + upper * np.sin(shoulder) + (lower + hand) * np.sin(pitch)
    return np.column_stack([out * np.cos(yaw), up, -out * np.sin(yaw)])
