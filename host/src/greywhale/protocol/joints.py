"""The joints that an arm uses: 1 to 4 of the four.

A parameter table, an arm and a log each say so by themselves (`joints_in_use`). The unused joint of a log is 0 in every
column, that of an arm is rigid at 0 rad, and on a board its follower has no potentiometer (a scale of 0).
"""

from __future__ import annotations

from collections.abc import Iterable

from greywhale.base.errors import BadUsage, UserError
from greywhale.protocol.firmware import JOINTS

Joints = tuple[int, ...]
ALL: Joints = tuple(range(JOINTS))
# Their names in the data of others, where a number says nothing: `yaw.pos`.
NAMES = ("yaw", "shoulder", "wrist_pitch", "wrist_roll")


def parse(text: str, where: str = "--joints") -> Joints:
    """The joints of a list such as "0,1", in order; raises UserError naming `where` for anything else."""
    words = [word.strip() for word in text.split(",")]
    if not all(word in map(str, ALL) for word in words) or len(set(words)) < len(words):
        raise BadUsage(f"{where}: {text!r} is no list of joints; give one or more of 0 to 3, each once, such as 0,1.")
    return tuple(sorted(map(int, words)))


def listed(joints: Iterable[int]) -> str:
    """The form that `parse` reads: 0,1."""
    return ",".join(map(str, joints))


def named(joints: Joints) -> str:
    """The joints as a sentence has them: joint 2; joints 0 and 1; joints 0, 1 and 3; all four joints."""
    if joints == ALL:
        return "all four joints"
    if len(joints) < 2:
        return f"joint {listed(joints)}"
    *before, last = map(str, joints)
    return f"joints {', '.join(before)} and {last}"


def unused(joints: Joints) -> Joints:
    """The joints that are not among these."""
    return tuple(joint for joint in ALL if joint not in joints)


def require_same(one: str, joints: Joints, other: str, others: Joints) -> None:
    """Raise UserError where two sources, such as an arm file and a log, do not use the same joints."""
    if joints != others:
        raise UserError(
            f"{one} uses {named(joints)}, but {other} uses {named(others)}. In an arm file, `fixed = true` says that a "
            "joint is not in use; on a board, `greywhale calibrate --joints` does."
        )
