"""The voltage that would hold a joint that sank under its own weight, as a log and the arm file's motor tell it."""

from __future__ import annotations

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.body import Body
from greywhale.arm.parameters import JOINT_NAMES
from greywhale.arm.plants import plant_row
from greywhale.commission.limits import COMMISSIONING_LIMITS, MotionLimits
from greywhale.files.log import Log
from greywhale.protocol.firmware import JOINTS


def describe_sinking(
    log: Log, joint: int, arm: ArmParameters, limits: MotionLimits = COMMISSIONING_LIMITS.motion
) -> str:
    """A clause where the joint ends a log on its way down, below its leader and against its voltage; "" otherwise.

    The arm's masses say which way is down, and its motor's damping how many volts the speed adds. The log says the
    rest, so that a load that no file knows counts, too.
    """
    if len(log.time) < 2:
        return ""
    last = log.time > log.time[-1] - limits.sinking_s
    pose = log.follower[last].mean(axis=0)[None]
    up = np.sign(Body.of(plant_row(arm)).bias(pose, np.zeros((1, JOINTS)))[0, joint])
    speed = up * np.polyfit(log.time[last] - log.time[-1], log.follower[last, joint], 1)[0]
    given = up * float(log.voltage[last, joint].mean())
    behind = up * float((log.leader[last, joint] - log.follower[last, joint]).mean())
    if not (up and speed < 0.0 < given and behind > 0.0):
        return ""
    actuator = arm.actuator(joint)
    hold = given - actuator.damping / actuator.torque_per_volt * speed
    more = f", more than its supply of {arm.drive.supply:g} V" if hold > arm.drive.supply else ""
    return (
        f", and joint {joint} ({JOINT_NAMES[joint]}) sank against {given:.1f} V: unless its motor is the wrong way "
        f"round, it takes about {hold:.2g} V to hold its weight there{more}"
    )
