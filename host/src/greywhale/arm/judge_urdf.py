"""Judges what a URDF says by what it would mean: bodies that cannot be, other units, motors that do not fit the arm."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from greywhale.arm.limits import DOUBTS
from greywhale.arm.summary import JointSummary
from greywhale.arm.urdf_joint import TurningJoint
from greywhale.base.errors import BadUsage, cut
from greywhale.base.types import Floats

_PRODUCTS = ((0, 1, "ixy"), (0, 2, "ixz"), (1, 2, "iyz"))


def why_no_body(inertia: Floats) -> str:
    """The reason why no body has this inertia (3, 3), kg m², about its centre of mass; "" where one may."""
    own = np.diag(inertia)
    moments = np.linalg.eigvalsh(inertia)
    slack = DOUBTS.rounding_share * max(float(np.abs(moments).max()), 0.0)
    for moment, name in zip(own, ("ixx", "iyy", "izz"), strict=True):
        if moment < -slack:
            return f"its moment {name} is {moment:g} kg m2, but none is below 0"
    if moments[0] < -slack:
        for one, other, name in _PRODUCTS:
            most = float(np.sqrt(max(own[one], 0.0) * max(own[other], 0.0)))
            if abs(inertia[one, other]) > most:
                return f"its product of inertia {name} is {inertia[one, other]:g} kg m2, but its moments allow {most:g}"
        return "its products of inertia contradict each other: turned to its own axes, a moment would be below 0"
    if moments[2] > moments[0] + moments[1] + slack:
        listed = ", ".join(f"{moment:.4g}" for moment in moments)
        return (
            f"its moments about its own axes are {listed} kg m2, but none is more than the two others together "
            "(triangle inequality)"
        )
    return ""


def require_reach(path: Path, joints: Sequence[TurningJoint]) -> None:
    """Refuse an arm that is only possible in another unit of length. Raises UserError by name."""
    ways = _ways(joints)
    reach = sum(ways)
    if reach > DOUBTS.furthest_reach_m:
        longest = int(np.argmax(ways))
        unit = "mm" if reach > 100.0 * DOUBTS.furthest_reach_m else "cm or mm"
        raise BadUsage(
            f"{path}: what joint {cut(joints[longest].name)} carries is {ways[longest]:g} m long, and the whole arm "
            f"{reach:g} m; lengths are in m, and these look like {unit}: correct them."
        )


def require_masses(path: Path, joints: Sequence[TurningJoint]) -> None:
    """Refuse masses and inertias that are only possible in another unit. Raises UserError by name.

    The first link's do not count: it may be a heavy turntable, wider than it is high.
    """
    reach, bodies = sum(_ways(joints)), [joint.body for joint in joints[1:]]
    for body in bodies:
        radius = float(np.sqrt(np.linalg.eigvalsh(body.inertia)[2] / body.mass))
        if radius > DOUBTS.most_gyration_reaches * reach:
            raise BadUsage(
                f"{path}: the inertia of link {cut(body.names[0])} is that of a ring with a radius of {radius:.3g} m, "
                f"on an arm of {reach:.3g} m; inertias are in kg m2 (1 kg mm2 is 1e-6, 1 g mm2 is 1e-9): correct it."
            )
    if sum(body.mass for body in bodies) > DOUBTS.densest_kg_m3 * reach**3:
        heaviest = max(bodies, key=lambda body: body.mass)
        raise BadUsage(
            f"{path}: link {cut(heaviest.names[0])} has {heaviest.mass:g} kg on an arm of {reach:.3g} m; masses are in "
            "kg, and this looks like g: correct it."
        )


def _ways(joints: Sequence[TurningJoint]) -> list[float]:
    """From each joint to the next one, and from the last to the centre of what it carries, m."""
    between = [float(np.linalg.norm(after.point - before.point)) for before, after in pairwise(joints)]
    return [*between, float(np.linalg.norm(joints[-1].body.centre - joints[-1].point))]


def doubts(joints: Sequence[TurningJoint], found: Sequence[JointSummary]) -> list[str]:
    """A sentence for each motor that is too strong, too weak, too fast or too slow to be meant so."""
    largest = max(one.gravity for one in found)
    doubts = []
    for joint, one in zip(joints, found, strict=False):
        name = f"joint {cut(joint.name)}"
        if joint.friction >= joint.effort:
            doubts.append(
                f"{name} has a friction of {joint.friction:g} N m and an effort of {joint.effort:g} N m: its motor "
                "cannot turn it."
            )
        if largest > 0.0 and one.stall > DOUBTS.far_too_strong_ratio * largest:
            doubts.append(
                f"{name} has an effort of {joint.effort:g} N m, {one.stall / largest:.0f} times the largest torque of "
                "gravity on this arm: write what its motor really gives, in N m."
            )
        elif one.stall < DOUBTS.far_too_weak_ratio * one.gravity:
            doubts.append(
                f"{name} has an effort of {joint.effort:g} N m against {one.gravity:.3g} N m of gravity: is the effort "
                "in N m, and are the masses in kg?"
            )
        if not DOUBTS.slowest_rad_s <= joint.velocity <= DOUBTS.fastest_rad_s:
            doubts.append(f"{name} has a velocity of {joint.velocity:g} rad/s: is it in rad/s, and at the joint?")
    return doubts
