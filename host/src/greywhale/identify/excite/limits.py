"""A motion's limits on this arm: ranges, speeds, accelerations per joint; and other arms on which it must be safe."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.body import Body
from greywhale.base.errors import BadUsage, UserError
from greywhale.base.types import Floats
from greywhale.identify import sampled_plants
from greywhale.identify.limits import IDENTIFICATION_LIMITS, ExcitationLimits
from greywhale.identify.space import MOTOR, Space
from greywhale.loop import plant_row
from greywhale.protocol.firmware import FASTEST_LED_RAD_S, JOINTS
from greywhale.protocol.joints import require_same
from greywhale.protocol.table import ParameterTable

FARTHEST_RAD = 7.0  # beyond any potentiometer's track
FAMILY = 15  # arms on which a motion is tried


@dataclass(frozen=True)
class Limits:
    """Per joint: `low`, `high` (rad), `speed` (rad/s), `acceleration` (rad/s²); `lag` in rad for all."""

    pose: Floats
    low: Floats
    high: Floats
    speed: Floats
    acceleration: Floats
    lag: float


def limits_of(
    arm: ArmParameters,
    table: ParameterTable,
    pose: Floats,
    ranges: Mapping[int, tuple[float, float]],
    wanted: ExcitationLimits = IDENTIFICATION_LIMITS.excitation,
) -> Limits:
    """The limits of a motion from `pose` (rad) with the board's parameter table and the user's ranges (rad).

    A joint that is not in use has no range: it stays at 0. Raises UserError where arm and board use other joints.
    """
    low, high = room_of(arm, table, pose, ranges, wanted)
    speed, acceleration = _strength(arm, table, low, high, wanted)
    tracking = table.physical("tracking_limit") or wanted.usual_tracking_rad
    lag = wanted.lag_share * min(tracking, wanted.usual_tracking_rad)
    return Limits(pose, low, high, speed, acceleration, lag)


def room_of(
    arm: ArmParameters,
    table: ParameterTable,
    pose: Floats,
    ranges: Mapping[int, tuple[float, float]],
    wanted: ExcitationLimits = IDENTIFICATION_LIMITS.excitation,
) -> tuple[Floats, Floats]:
    """The least and the largest angles (4,) rad of such a motion."""
    require_same("the arm file", arm.joints_in_use, "the board", table.joints_in_use)
    for joint in ranges:
        if joint not in arm.joints_in_use:
            raise BadUsage(f"--range names joint {joint}, which is not in use; leave it out.")
    low, high = np.zeros(JOINTS), np.zeros(JOINTS)
    for joint in arm.joints_in_use:
        stops = arm.joint[joint].stops
        least = max(table.physical(f"joint{joint}.limit_min"), stops.min) + wanted.margin_rad
        most = min(table.physical(f"joint{joint}.limit_max"), stops.max) - wanted.margin_rad
        low[joint], high[joint] = _range(joint, pose[joint], ranges.get(joint), least, most, wanted)
    return low, high


def _range(
    joint: int,
    pose: float,
    asked: tuple[float, float] | None,
    least: float,
    most: float,
    wanted: ExcitationLimits,
) -> tuple[float, float]:
    low, high = asked if asked is not None else (pose - wanted.reach_rad, pose + wanted.reach_rad)
    low, high = max(low, least), min(high, most)
    if not low <= pose <= high:
        raise UserError(
            f"joint {joint} is at {pose:.2f} rad, outside of the range {low:.2f} to {high:.2f} rad that its limits, "
            "the arm's stops and --range leave; move it inside, or give another --range."
        )
    if high - low < wanted.narrowest_rad:
        raise UserError(
            f"the range of joint {joint} is {low:.2f} to {high:.2f} rad, less than {wanted.narrowest_rad:g} rad; give "
            "a wider --range, or move the joint away from its limit."
        )
    return low, high


def _strength(
    arm: ArmParameters, table: ParameterTable, low: Floats, high: Floats, wanted: ExcitationLimits
) -> tuple[Floats, Floats]:
    """The speeds and accelerations for which a part of the voltage is enough, by the arm file."""
    body, fastest = Body.of(plant_row(arm)), min(wanted.max_speed_rad_s, FASTEST_LED_RAD_S / 1.5)
    random = np.random.default_rng(0)
    poses = random.uniform(low, high, (200, JOINTS))
    still = np.zeros_like(poses)
    gravity = np.abs(body.bias(poses, still)).max(axis=0)
    inertia = np.diagonal(body.mass_matrix(poses), axis1=1, axis2=2).max(axis=0)
    speed, acceleration = np.ones(JOINTS), np.ones(JOINTS)  # those not in use do not move anyway
    for joint in arm.joints_in_use:
        motor = arm.actuator(joint)
        alpha = 1.0 / motor.torque_per_volt
        volts = min(table["supply_mv"], table[f"joint{joint}.ku_mv"]) / 1000.0
        free = volts - alpha * gravity[joint]
        if free <= 0.2 * volts:
            weight = alpha * gravity[joint]
            raise UserError(
                f"by the arm file the motor of joint {joint} can hardly lift its own weight: {weight:.1f} V of "
                f"{volts:.1f} V; narrow its --range, or correct the arm file."
            )
        speed[joint] = min(fastest, wanted.speed_share * free / (alpha * motor.damping))
        acceleration[joint] = wanted.acceleration_share * free / (alpha * (motor.inertia + inertia[joint]))
    return speed, acceleration


def family(arm: ArmParameters, seed: int = 0, wanted: ExcitationLimits = IDENTIFICATION_LIMITS.excitation) -> Floats:
    """Plants (1 + 15, columns): the arm itself, then arms that it might be.

    For an identified model they are drawn from its covariance. For an arm file their motors are wrong by up to a factor
    of two, and they have friction of their own.
    """
    if "covariance" in (arm.identification or {}):
        return sampled_plants(arm, 1 + FAMILY, seed)
    space = Space.of(arm, (*MOTOR, "coulomb"), arm.joints_in_use)
    x = space.start()
    random = np.random.default_rng(seed)
    doubt = wanted.motor_doubt_log
    points = x + random.uniform(-doubt, doubt, (FAMILY, len(x)))
    friction = [index for index, one in enumerate(space.parameters) if one.kind == "coulomb"]
    points[:, friction] = np.log(random.uniform(*wanted.friction_v, (FAMILY, len(friction))))
    return np.vstack([space.plants(x[None]), space.plants(points)])


def parse_range(text: str) -> tuple[int, tuple[float, float]]:
    """Read `J:min:max` of the command line."""
    parts = text.split(":")
    try:
        joint, low, high = int(parts[0]), float(parts[1]), float(parts[2])
        good = len(parts) == 3 and 0 <= joint < JOINTS
    except (ValueError, IndexError):
        good = False
    if not good:
        raise BadUsage(
            f'--range is "{text}", but it must be JOINT:MIN:MAX with a joint 0..{JOINTS - 1} and two angles in rad, '
            "such as 1:-0.5:0.8."
        )
    if not -FARTHEST_RAD < low < high < FARTHEST_RAD:
        raise BadUsage(
            f'--range is "{text}", but MIN must be less than MAX, and both within ±{FARTHEST_RAD:g} rad, such as '
            f"{joint}:-0.5:0.8."
        )
    return joint, (low, high)
