"""A URDF's chain of one to three turning joints, from the base on, completed to the four joints of this arm.

The joints that are missing stand beyond the last body, in line with it, and carry next to nothing.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.arm.urdf_joint import Body, TurningJoint
from greywhale.base.errors import BadUsage, cut
from greywhale.base.types import Floats

UP = np.array([0.0, 0.0, 1.0])
NOTHING_KG, NOTHING_KG_M2 = 1e-8, 1e-14  # of a link that is not there, but must have some
SHORTEST_M = 2e-3  # from a joint to the centre of what it moves


def complete(path: Path, joints: list[TurningJoint]) -> list[TurningJoint]:
    """Four joints; those that are added have no name. Raises UserError where the chain is none of this arm."""
    if len(joints) == len(JOINT_NAMES):
        return joints
    if not 1 <= len(joints) < len(JOINT_NAMES):
        raise BadUsage(
            f"{path}: it has {len(joints)} turning joints, but greywhale's arm has one to four: "
            f"{', '.join(JOINT_NAMES)}, from the base on."
        )
    found = list(joints)
    if len(found) == 1:
        beyond = joints[0].point + max(float((joints[0].body.centre - joints[0].point) @ UP), SHORTEST_M) * UP
        level = np.array([0.0, 1.0, 0.0])
        ahead = np.cross(level, UP)
        found += [_idle(beyond, level, ahead), _idle(beyond + SHORTEST_M * ahead, level, ahead)]
        return [*found, _idle(beyond + 2.0 * SHORTEST_M * ahead, ahead, ahead)]
    pitch = joints[1].axis
    last = joints[-1]
    # Where on its axis the last joint stands changes nothing; this arm's are in the plane of the yaw's axis.
    start = last.point - ((last.point - joints[0].point) @ pitch) * pitch
    reach = last.body.centre - start
    reach = reach - (reach @ pitch) * pitch
    length = float(np.linalg.norm(reach))
    if length < SHORTEST_M:
        raise BadUsage(
            f"{path}: the centre of mass of link {cut(last.body.names[0])} lies on the axis of joint {cut(last.name)}, "
            "so nobody can say where that link points; describe it as a joint with a link."
        )
    along = reach / length
    end = start + 2.0 * length * along
    if len(found) == 2:
        found.append(_idle(end, pitch, along))
        end = end + SHORTEST_M * along
    return [*found, _idle(end, along, along)]


def _idle(point: Floats, axis: Floats, along: Floats) -> TurningJoint:
    body = Body()
    body.add("", NOTHING_KG, point + 0.5 * SHORTEST_M * along, NOTHING_KG_M2 * np.eye(3))
    return TurningJoint("", point, axis, -1.0, 1.0, 0.0, 0.0, math.nan, math.nan, body)
