"""An arm from a URDF: a yaw, two parallel pitches and a roll along the last link, in whatever frames and zero pose.

greywhale's own zero pose has all links stretched out level. `Imported` says where that is in the URDF's angles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from greywhale.arm.fewer_joints import UP, complete
from greywhale.arm.judge_urdf import doubts, require_masses, require_reach
from greywhale.arm.limits import URDF
from greywhale.arm.parameters import JOINT_NAMES, ArmParameters
from greywhale.arm.summary import Summary, summarise
from greywhale.arm.urdf import read_chain
from greywhale.arm.urdf_joint import Body, TurningJoint
from greywhale.arm.urdf_motor import joint_table, remarks_on, with_guessed_motors
from greywhale.base.errors import BadUsage, UserError, cut
from greywhale.base.formats import toml_file
from greywhale.base.types import Floats

PARALLEL = math.cos(math.radians(1.0))
ACROSS = math.sin(math.radians(1.0))
ROUNDING_M = 1e-9  # by which sums of lengths may be off


@dataclass(frozen=True)
class Imported:
    """An arm, and q = sign x (URDF's angle) + offset (rad) for each joint; `remarks`: what was left out or guessed.

    `summary` is what the arm can lift and how fast it is, with a warning for each thing that will not do.
    """

    arm: ArmParameters
    signs: Floats
    offsets: Floats
    remarks: tuple[str, ...]
    summary: Summary


@dataclass(frozen=True)
class _Frames:
    """The arm at the URDF's zero pose: points (3,) m and directions (3,), all in the base's frame."""

    points: tuple[Floats, Floats, Floats, Floats]  # of the four joints, on the arm's plane
    along: tuple[Floats, Floats, Floats, Floats]  # each link's x
    pitch: Floats  # the axis about which a positive pitch raises
    lengths: tuple[float, float, float]


def import_urdf(path: Path, supply_v: float) -> Imported:
    """Read a URDF; effort and velocity limits are what the motors give at `supply_v`. Raises UserError by name.

    A chain that ends before the wrist's roll is an arm whose last joints are fixed.
    """
    name, joints = read_chain(path)
    used = len(joints)
    for joint in joints:
        if joint.body.mass <= 0.0:
            raise _empty(path, joint.body, "mass")
    joints = complete(path, joints)
    require_reach(path, joints[:used])
    frames = _find_frames(path, joints)
    signs, offsets = _angles(joints, frames)
    remarks: list[str] = []
    links = [_link(path, number, joints[number], frames, remarks) for number in range(len(joints))]

    def build(joints: list[TurningJoint]) -> ArmParameters:
        tables = [
            joint_table(number, joint, signs[number], offsets[number], supply_v)
            if number < used
            else {"name": JOINT_NAMES[number], "fixed": True}
            for number, joint in enumerate(joints)
        ]
        data = {"name": name, "source": path.name, "link": links, "joint": tables, "drive": {"supply": supply_v}}
        try:
            return toml_file.check(data, ArmParameters, str(path))
        except UserError as error:
            raise BadUsage(error.message) from None

    undriven = build(joints)
    require_masses(path, joints[:used])
    driven = with_guessed_motors(joints, undriven)
    for number, pair in enumerate(zip(joints[:used], driven, strict=False)):
        remarks += remarks_on(number, *pair, signs[number], offsets[number])
    arm = build(driven)
    summary = summarise(arm)
    warnings = (*summary.warnings, *doubts(driven[:used], summary.joints))
    return Imported(arm, signs, offsets, tuple(remarks), replace(summary, warnings=warnings))


def _find_frames(path: Path, joints: list[TurningJoint]) -> _Frames:
    yaw, shoulder, wrist, roll = joints

    def bad(joint: TurningJoint, what: str) -> UserError:
        place = JOINT_NAMES[joints.index(joint)]
        return BadUsage(f"{path}: joint {cut(joint.name)}, the {place}, {what}.")

    if abs(yaw.axis @ UP) < PARALLEL:
        raise bad(yaw, "does not turn about the vertical")
    if abs(shoulder.axis @ UP) > ACROSS:
        raise bad(shoulder, "does not turn about a level axis")
    if abs(wrist.axis @ shoulder.axis) < PARALLEL:
        raise bad(wrist, "does not turn about an axis parallel to the shoulder's")
    if abs(roll.axis @ shoulder.axis) > ACROSS:
        raise bad(roll, "does not turn about an axis across the wrist's")
    pitch = shoulder.axis - (shoulder.axis @ UP) * UP
    pitch /= np.linalg.norm(pitch)
    # Points of the pitch axes in the upright plane through the yaw axis.
    points = [yaw.point, *(one.point - ((one.point - yaw.point) @ pitch) * pitch for one in (shoulder, wrist))]
    beside = (points[1] - yaw.point) @ np.cross(UP, pitch)
    if abs(beside) > URDF.beside_m:
        raise bad(shoulder, f"has its axis {1e3 * abs(beside):.0f} mm beside the yaw's, which this arm cannot have")
    points[1] = points[1] - beside * np.cross(UP, pitch)
    first = points[2] - points[1]
    if np.linalg.norm(first) < URDF.shortest_m:
        raise bad(wrist, "has the shoulder's axis")
    away = roll.point - points[2]
    for direction, what in ((pitch, "the arm's plane"), (np.cross(pitch, roll.axis), "the wrist's axis")):
        if abs(away @ direction) > URDF.beside_m:
            raise bad(roll, f"has its axis {1e3 * abs(away @ direction):.0f} mm beside {what}")
    outwards = roll.body.centre - points[2] if roll.body.mass else away
    second = roll.axis * (1.0 if outwards @ roll.axis >= 0.0 else -1.0)
    # Where on its axis the roll joint stands changes nothing; between the two centres of mass it fits this arm.
    centres = [float((one.body.centre - points[2]) @ second) for one in (wrist, roll)]
    length = max(URDF.shortest_m, min(max(float(away @ second), centres[0]), centres[1]))
    points.append(points[2] + length * second)
    along = first / np.linalg.norm(first)
    forward = _forward(along, second, pitch)
    if np.cross(forward, UP) @ pitch < 0.0:
        pitch = -pitch
    height = max(float((points[1] - points[0]) @ UP), URDF.shortest_m)
    return _Frames(
        (points[0], points[1], points[2], points[3]),
        (UP, along, second, second),
        pitch,
        (height, float(np.linalg.norm(first)), length),
    )


def _forward(along: Floats, second: Floats, pitch: Floats) -> Floats:
    """The level direction in which the arm reaches; any, where it stands upright as a whole."""
    for direction in (along, second):
        level = direction - (direction @ UP) * UP
        if np.linalg.norm(level) > 0.1:
            return np.asarray(level / np.linalg.norm(level))
    return np.asarray(np.cross(UP, pitch))


def _angles(joints: list[TurningJoint], frames: _Frames) -> tuple[Floats, Floats]:
    """Signs and offsets of greywhale's angles, (4,) each."""
    axes = (UP, frames.pitch, frames.pitch, frames.along[3])
    signs = np.array([1.0 if joint.axis @ axis > 0.0 else -1.0 for joint, axis in zip(joints, axes, strict=True)])
    forward = np.cross(UP, frames.pitch)
    raised = [math.atan2(float(one @ UP), float(one @ forward)) for one in frames.along[1:3]]
    bent = math.remainder(raised[1] - raised[0], math.tau)
    return signs, np.array([0.0, raised[0], bent, 0.0])


def _link(path: Path, number: int, joint: TurningJoint, frames: _Frames, remarks: list[str]) -> dict[str, Any]:
    """Mass, length, centre and inertias in the link's own axes."""
    body, along = joint.body, frames.along[number]
    axes = _axes(number, along, frames.pitch)
    inertia = axes @ body.inertia @ axes.T
    centre = axes @ (body.centre - frames.points[number])
    if number == 0:  # only what turns about the vertical counts
        turning = float(inertia[1, 1] + body.mass * (centre[0] ** 2 + centre[2] ** 2))
        length = max(frames.lengths[0], 2.0 * abs(float(centre[1])))
        return _table(body, length, length / 2.0, np.array([turning, turning, turning]))
    if not np.diag(inertia).max() > 0.0:
        raise _empty(path, body, "inertia")
    reach = float(centre[0])
    length = frames.lengths[number] if number < 3 else max(2.0 * reach, URDF.shortest_m)
    aside = float(np.linalg.norm(centre[1:]))
    if aside > max(URDF.aside_share * length, URDF.aside_m):
        raise BadUsage(
            f"{path}: the centre of mass of link {cut(body.names[0])} is {1e3 * aside:.0f} mm beside the line of the "
            "link, which this arm cannot have."
        )
    if not -ROUNDING_M <= reach <= length + ROUNDING_M:
        raise BadUsage(
            f"{path}: the centre of mass of link {cut(body.names[0])} is {1e3 * reach:.0f} mm along a link of "
            f"{1e3 * length:.0f} mm; it must lie between the link's joints."
        )
    if aside > 1e-6:
        remarks.append(f"the centre of mass of {cut(body.names[0])} was moved by {1e3 * aside:.1f} mm onto the link")
    products = float(np.abs(inertia - np.diag(np.diag(inertia))).max() / np.diag(inertia).max())
    if products > 0.02:
        share = f"{100 * products:.0f} % of the largest moment"
        remarks.append(f"products of inertia of {cut(body.names[0])} were left out ({share})")
    return _table(body, length, min(max(reach, 0.0), length), _rounded(body, np.diag(inertia).copy(), remarks))


def _rounded(body: Body, moments: Floats, remarks: list[str]) -> Floats:
    """Moments that a body may have, where rounded digits make one a little more than the two others together."""
    largest = int(np.argmax(moments))
    rest = float(np.delete(moments, largest).sum())
    if moments[largest] > rest:
        remarks.append(
            f"a moment of inertia of {cut(body.names[0])} was made {100 * (1 - rest / moments[largest]):.2g} % less, "
            "as no body has one that is more than the two others together"
        )
        moments[largest] = rest
    return moments


def _empty(path: Path, body: Body, what: str) -> UserError:
    return BadUsage(f"{path}: link {cut(body.names[0])} has no {what}; every moving link needs some.")


def _axes(number: int, along: Floats, pitch: Floats) -> Floats:
    """(3, 3): rows are the link's x, y and z; link 0 stands upright, its y is up."""
    if number == 0:
        return np.array([np.cross(UP, pitch), UP, pitch])
    return np.array([along, np.cross(pitch, along), pitch])


def _table(body: Body, length: float, centre: float, inertia: Floats) -> dict[str, Any]:
    xx, yy, zz = map(float, inertia)
    return {"mass": body.mass, "length": length, "centre": centre, "inertia": {"xx": xx, "yy": yy, "zz": zz}}
