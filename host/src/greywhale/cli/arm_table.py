"""Prints the load that an arm can lift and its speed, for a person and for a program."""

from __future__ import annotations

from typing import Annotated, TypedDict

import numpy as np

from greywhale.arm.make import Summary
from greywhale.arm.parameters import JOINT_NAMES, ArmParameters
from greywhale.arm.summary import JointSummary
from greywhale.base.telling import Column, Part, Row, Sentences, Table
from greywhale.protocol.table import ParameterTable


class JointFacts(TypedDict):
    joint: int
    gravity_nm: float  # the largest torque of gravity
    stall_nm: float  # the motor's torque at standstill
    no_load_speed_rad_s: float
    hold_v: float  # holds the worst pose
    holds_without_power: bool


class Lifting(TypedDict):
    """The table and what follows from it."""

    mass_kg: float
    joints: Annotated[list[JointFacts], ("minItems", 1), ("maxItems", 4)]  # in use
    warnings: list[str]
    before_it_moves: str  # what to do; empty where nothing


COLUMNS = (
    Column(width=16, left=True),
    Column("gravity, at most", width=17),
    Column("motor at standstill", width=20),
    Column("share", width=7),
    Column("fastest", width=13),
)


def table(arm: ArmParameters, found: Summary) -> list[Part]:
    """Gravity against motor for each joint, and its speed."""

    def row(one: JointSummary) -> Row:
        torques = (f"{value:.3g} N m" for value in (one.gravity, one.stall))
        speed = f"{np.degrees(one.no_load_speed):.0f} deg/s"
        return Row((JOINT_NAMES[one.joint], *torques, f"{100 * one.share:.0f} %", speed))

    title = Sentences((f"{arm.name}: {found.mass:.3g} kg, motors at {arm.drive.supply:g} V.",))
    return [title, Table(COLUMNS, [row(one) for one in found.joints])]


def notes(found: Summary, left_out: tuple[str, ...] = ()) -> list[Part]:
    """Warnings, what to do before it moves, and which answers were left out."""
    lines = [f"Warning: {warning}" for warning in found.warnings]
    if before := advice(found):
        lines.append(f"Before it moves: {before}")
    if left_out:
        lines.append(f"Note: the file leaves out {len(left_out)} answers, taken as usual: {', '.join(left_out)}.")
    return [Sentences(lines)] if lines else []


def advice(found: Summary) -> str:
    """Advice for a board as shipped if the arm's motors have much to hold; "" where it needs nothing."""
    hold = max(one.hold_v for one in found.joints)
    shipped = ParameterTable.defaults().physical("stall_volts")
    if hold <= 0.6 * shipped or any(one.share >= 1.0 for one in found.joints):  # the rest is for starting
        return ""
    return (
        f"a joint needs {hold:.1f} V to hold still, and the board holds a joint back that has more than stall_volts "
        f"({shipped:g} V) without motion: run `greywhale params set stall_volts={np.ceil(1.5 * hold):.0f}`."
    )


def lifting(found: Summary) -> Lifting:
    """The table's numbers for a program."""
    joints: list[JointFacts] = [
        {
            "joint": one.joint,
            "gravity_nm": round(one.gravity, 6),
            "stall_nm": round(one.stall, 6),
            "no_load_speed_rad_s": round(one.no_load_speed, 6),
            "hold_v": round(one.hold_v, 4),
            "holds_without_power": one.holds,
        }
        for one in found.joints
    ]
    return {
        "mass_kg": round(found.mass, 6),
        "joints": joints,
        "warnings": list(found.warnings),
        "before_it_moves": advice(found),
    }
