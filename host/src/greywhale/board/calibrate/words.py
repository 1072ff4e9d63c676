"""Instructions to the person: joints by name, and which way of each is positive."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.types import Floats
from greywhale.board.calibrate.rules import words
from greywhale.board.refusal import pot_name, upper_first
from greywhale.protocol.firmware import JOINTS
from greywhale.protocol.joints import Joints

POSITIVE_WAYS = tuple(words("positive_way", joint) for joint in range(JOINTS))
HOW_TO_ANSWER = (
    "Enter: done. b: back to the step before. a: this step again. s: this sweep later. q: end; nothing is stored then."
)
MEND = "mend it, then comes this sweep again. Enter: now. b: the one before. s: this one later. q: end."
MEND_POSE = "This pose comes again; b goes back to an earlier step."


def joint_name(pot: int) -> str:
    """leader joint 1, shoulder pitch."""
    return f"{pot_name(pot).replace(' potentiometer ', ' joint ')}, {JOINT_NAMES[pot % JOINTS]}"


def sweep_asked(pot: int, number: int, of: int) -> str:
    return f"Sweep {number} of {of}: {joint_name(pot)}. {upper_first(words('turn_asked', pot % JOINTS))}"


def poses_asked(first: Floats, second: Floats | None, joints: Joints) -> Sequence[tuple[Floats, str]]:
    """The four poses: angles (4,) where they count, and what is asked."""
    first_pose, unknown = _in_words(first, joints), np.zeros(JOINTS)
    known = None if second is None else f"now hold both arms in this pose: {_in_words(second, joints)}."
    other = "now hold both arms in one and the same other pose, every joint at least 20 degrees away."
    return (
        (first, f"Pose 1 of 4: hold both arms in this pose: {first_pose}."),
        (unknown if second is None else second, f"Pose 2 of 4: {known or other}"),
        (first, f"Pose 3 of 4: once more the first pose: {first_pose}."),
        (unknown, "Pose 4 of 4: hold both arms in one and the same third pose, away from the other two."),
    )


def motors_asked(supply_v: float) -> str:
    return (
        "Each motor now gets short weak pulses, of a tenth to a third of the supply. The board counts on "
        f"{supply_v:g} V: if the motors' supply has not, end here and set supply_mv first. {words('ready_asked')}"
    )


def motor_named(joint: int, joints: Joints) -> str:
    """Motor 2 of 4, joint 1, shoulder pitch."""
    return f"Motor {joints.index(joint) + 1} of {len(joints)}, joint {joint}, {JOINT_NAMES[joint]}"


def _in_words(angles: Floats, joints: Joints) -> str:
    if not angles[list(joints)].any():
        return "every joint at 0 (stretched out, level)"
    return ", ".join(f"joint {joint} at {np.degrees(angles[joint]):.0f} degrees" for joint in joints)
