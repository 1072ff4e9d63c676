"""Motors, friction and stops of a URDF's joints in an arm's terms, and a guess where the URDF does not know."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from greywhale.arm.body import Body
from greywhale.arm.limits import GUESSES
from greywhale.arm.parameters import JOINT_NAMES, ArmParameters
from greywhale.arm.plants import plant_row
from greywhale.arm.urdf_joint import TurningJoint
from greywhale.base.errors import cut


def joint_table(number: int, joint: TurningJoint, sign: float, offset: float, supply_v: float) -> dict[str, Any]:
    """Motor and friction at the joint itself (gear ratio 1): half the damping is the motor's, half its own."""
    effort, velocity = joint.effort or 1.0, joint.velocity or GUESSES.rad_s
    torque_per_volt, damping = effort / supply_v, effort / velocity
    friction = 0.0 if math.isnan(joint.friction) else joint.friction
    low, high = _ends(joint, sign, offset)
    return {
        "name": JOINT_NAMES[number],
        "motor": {
            "inertia": GUESSES.inertia_kg_m2[number],
            "resistance": 0.5 * damping / torque_per_volt**2,
            "torque_constant": 0.5 * damping / torque_per_volt,
            "viscous": 0.5 * damping,
            "gear_ratio": 1.0,
        },
        "friction": {"coulomb": friction, "breakaway": friction},
        "stops": {"min": max(low, -math.tau), "max": min(high, math.tau)},
    }


def with_guessed_motors(joints: Sequence[TurningJoint], arm: ArmParameters) -> list[TurningJoint]:
    """The joints with an effort (N m) and a velocity (rad/s) where theirs are not known; `arm` has their links."""
    body, level = Body.of(plant_row(arm)), np.zeros((1, 4))
    gravity, moments = np.abs(body.bias(level, level)[0]), np.diag(body.mass_matrix(level)[0])
    needed = gravity + GUESSES.brisk_rad_s2 * (moments + np.array(GUESSES.inertia_kg_m2))
    return [
        replace(
            joint, effort=joint.effort or GUESSES.torque_ratio * float(nm), velocity=joint.velocity or GUESSES.rad_s
        )
        for joint, nm in zip(joints, needed, strict=True)
    ]


def remarks_on(number: int, given: TurningJoint, used: TurningJoint, sign: float, offset: float) -> list[str]:
    """Remarks on a joint: values that were guessed or left out, given the URDF's own and those used instead."""
    name, remarks = f"joint {cut(given.name)}", []
    if not given.effort:
        remarks.append(
            f"{name} says no effort; {used.effort:.3g} N m is a guess, which carries the arm "
            f"{GUESSES.torque_ratio:g} times: put in what its motor gives"
        )
    if not given.velocity:
        remarks.append(f"{name} says no velocity; {GUESSES.rad_s:g} rad/s is a guess")
    ends = _ends(given, sign, offset)
    if given.endless:
        remarks.append(f"{name} turns for ever; its stops are a turn to either side")
    elif max(-ends[0], ends[1]) > math.tau:
        turns = " to ".join(f"{math.degrees(end):.0f}" for end in ends)
        remarks.append(f"the stops of {name}, {turns} degrees here, were cut to a turn to either side")
    said = used.effort / used.velocity
    if given.damping > 0.0 and abs(given.damping - said) > GUESSES.same_damping_share * said:
        remarks.append(
            f"the damping of {name}, {given.damping:.3g} N m s, was left out; effort by velocity, {said:.3g} N m s, "
            "stands for it"
        )
    remarks.append(
        f"the inertia of the {JOINT_NAMES[number]}'s motor is a guess, {GUESSES.inertia_kg_m2[number]:g} kg m2"
    )
    return remarks


def _ends(joint: TurningJoint, sign: float, offset: float) -> tuple[float, float]:
    """The joint's limits as greywhale counts its angle, the lower one first."""
    if joint.endless:
        return joint.low, joint.high
    low, high = sorted(sign * end + offset for end in (joint.low, joint.high))
    return low, high
