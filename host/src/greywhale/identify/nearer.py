"""Another start for joints whose torque per volt a fit took far from the arm file's.

Volts, and not torques, are what the motion of a light link shows. So a gear that knocks, or load friction, may be
explained as well by a motor of several times the torque, and a fit does not find its way back from there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from greywhale.base.types import Floats
from greywhale.identify.candidate import Candidate
from greywhale.identify.limits import SearchLimits
from greywhale.identify.space import COUPLED, WHOLE_ARM
from greywhale.identify.windows import WindowResidual

# What the motion shows whatever the torque is: it stays.
SHOWN = ("inertia", "damping", "coulomb", "gap", "play")


def far_joints(found: Candidate, limits: SearchLimits) -> list[int]:
    """The joints whose torque per volt is far from the arm file's, and those that feel them."""
    away = np.abs(found.x - found.space.start()) > limits.far_doubts * found.space.doubts()
    far = {
        one.joint for one, is_away in zip(found.space.parameters, away, strict=True) if one.kind == "alpha" and is_away
    }
    return [joint for coupled in COUPLED for joint in coupled if far & set(coupled)]


def with_nearer_torque(found: Candidate, joints: Sequence[int], gear: Mapping[str, float]) -> Candidate:
    """The model with the arm file's torque per volt and this gear on these joints, and what may hang on it there as
    usual, too.
    """
    other = found.with_values(gear).x
    usual = [one.kind not in SHOWN and one.kind not in gear for one in found.space.parameters]
    here = [one.joint in joints for one in found.space.parameters]
    return replace(found, x=np.where(here, np.where(usual, found.space.start(), other), found.x))


def cost(found: Candidate, held_out: WindowResidual) -> Floats:
    """By moving joint, minus the logarithm of how likely a model is by what is held out and by the arm file, save a
    constant. A window counts as one observation: a model's mistakes last for many readings in a row.
    """
    missed = held_out.windows * held_out.settled_error(found.plant, found.zero)
    away = ((found.x - found.space.start()) / found.space.doubts()) ** 2
    doubted = np.bincount([one.joint for one in found.space.parameters], away, WHOLE_ARM + 1)
    costs: Floats = missed + 0.5 * doubted[held_out.joints]
    return costs
