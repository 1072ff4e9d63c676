"""The beginning of a commissioning: finds out whether the arm moves freely, and refuses one that does not."""

from __future__ import annotations

import numpy as np

from greywhale.arm.parameters import JOINT_NAMES
from greywhale.base.errors import UserError
from greywhale.base.types import Floats
from greywhale.commission.arm_on_port import ArmOnPort
from greywhale.commission.journal import CommissioningJournal
from greywhale.commission.limits import COMMISSIONING_LIMITS, MotionLimits
from greywhale.commission.motions import JointRange, first_motion
from greywhale.files.log import Log
from greywhale.protocol.firmware import JOINTS


def refuse_stuck(
    arm: ArmOnPort,
    journal: CommissioningJournal,
    joint_range: JointRange,
    limits: MotionLimits = COMMISSIONING_LIMITS.motion,
) -> None:
    """Move every joint a little, then, where friction held one, a little more. Refuse an arm that does not follow."""
    if journal.get("first motion") is not None:
        return
    stuck: list[int] = []
    for number, size in enumerate((limits.first_rad, limits.first_again_rad), 1):
        motion, path = first_motion(joint_range, size, limits), journal.path(f"first-{number}.csv")
        played = arm.play(motion, path, arm.before, patient=True)
        if played.stopped:
            raise UserError(f"the arm cannot be commissioned: {played.stopped} in the little first motion.")
        shares = shares_moved(played.log)
        _refuse_backwards(shares, limits.least_way_share)
        stuck = [joint for joint in arm.before.joints_in_use if shares[joint] < limits.least_way_share]
        if not stuck:
            moved = [round(float(share), 3) for share in shares]
            journal.note("first motion", {"size_rad": size, "shares_moved": moved})
            return
    named = " and ".join(f"joint {joint} ({JOINT_NAMES[joint]})" for joint in stuck)
    raise UserError(
        f"{named} did not move when led by {limits.first_again_rad:g} rad; see that the arm is free, its motors have "
        "power, and each potentiometer is on its own joint."
    )


def shares_moved(log: Log) -> Floats:
    """Return how far each follower went, as a share of its leader's way; below 0 the other way. (4,)"""
    shares = np.zeros(JOINTS)
    for joint in range(JOINTS):
        leader, follower = log.leader[:, joint], log.follower[:, joint]
        moved = leader - leader[0]
        far = int(np.argmax(np.abs(moved)))
        late = slice(far, min(far + 500, len(leader)))
        way = follower[late] - np.median(follower[:50])
        share = way / moved[far] if moved[far] else np.zeros(1)
        shares[joint] = share[np.argmax(np.abs(share))]
    return shares


def _refuse_backwards(shares: Floats, least_share: float) -> None:
    wrong = int(np.argmin(shares))
    if shares[wrong] < -least_share:
        raise UserError(
            f"joint {wrong} ({JOINT_NAMES[wrong]}) moves away from its leader; swap its motor's wires, or set "
            f"joint{wrong}.motor_sign."
        )
