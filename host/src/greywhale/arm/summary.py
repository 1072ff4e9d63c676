"""The load that an arm can lift and its speed, before anybody builds on it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from greywhale.arm.body import Body
from greywhale.arm.limits import DOUBTS
from greywhale.arm.parameters import JOINT_NAMES, PITCH_JOINTS, ArmParameters
from greywhale.arm.plants import plant_row


@dataclass(frozen=True)
class JointSummary:
    """At the joint: the largest gravity torque and the motor's at standstill (N m), and its speed without load."""

    joint: int
    gravity: float
    stall: float
    no_load_speed: float  # rad/s
    hold_v: float  # V that hold the largest gravity torque
    holds: bool  # without power

    @property
    def share(self) -> float:
        """Of the motor's torque that gravity takes; without end where friction leaves the motor none."""
        if self.stall <= 0.0:
            return math.inf if self.gravity > 0.0 else 0.0
        return self.gravity / self.stall


@dataclass(frozen=True)
class Summary:
    """The joints in use, the mass that moves (kg), and a sentence for each thing that will not do."""

    joints: tuple[JointSummary, ...]
    mass: float
    warnings: tuple[str, ...]


def summarise(arm: ArmParameters) -> Summary:
    """Look at an arm stretched out level, where gravity pulls most."""
    gravity = Body.of(plant_row(arm)).bias(np.zeros((1, 4)), np.zeros((1, 4)))[0]
    joints = tuple(_joint(arm, joint, abs(float(gravity[joint]))) for joint in arm.joints_in_use)
    warnings = [warning for one in joints for warning in _warnings(arm, one.joint, one)]
    return Summary(joints, sum(link.mass for link in arm.link) + arm.tip.mass, tuple(warnings))


def _joint(arm: ArmParameters, joint: int, gravity: float) -> JointSummary:
    actuator, friction = arm.actuator(joint), arm.joint[joint].friction
    stall = actuator.torque_per_volt * arm.drive.supply - friction.coulomb
    hold = gravity / actuator.torque_per_volt
    return JointSummary(joint, gravity, stall, stall / actuator.damping, hold, friction.breakaway >= gravity)


def _warnings(arm: ArmParameters, joint: int, one: JointSummary) -> list[str]:
    name = f"joint {joint} ({JOINT_NAMES[joint]})"
    stops = arm.joint[joint].stops
    warnings = []
    if one.share >= 1.0:
        warnings.append(
            f"{name} cannot lift the arm: stretched out it needs {one.gravity:.3g} N m, and its motor has "
            f"{one.stall:.3g} N m at {arm.drive.supply:g} V; take a stronger motor, more gear or a spring."
        )
    elif one.share > DOUBTS.much_gravity_share:
        warnings.append(
            f"{name} lifts the arm with {100 * one.share:.0f} % of its motor's torque; little is left to move it, and "
            "a motor that holds so much gets hot; half is a good limit, a third is better."
        )
    if joint in PITCH_JOINTS and not one.holds:
        warnings.append(f"{name} sinks when its motor is off: support the arm before you switch off.")
    turn = stops.max - stops.min
    if turn > arm.follower_pots.joint[joint].track:
        warnings.append(
            f"{name} turns by {math.degrees(turn):.0f} degrees, more than the potentiometer's track of "
            f"{math.degrees(arm.follower_pots.joint[joint].track):.0f}: put stops in, or a gear before it."
        )
    return warnings
