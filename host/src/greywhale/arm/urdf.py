"""Reads a URDF as a chain of bodies at its zero pose, everything in the base's frame; fixed joints are welded."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree as xml

import numpy as np

from greywhale.base.errors import BadUsage, UserError, cut, os_reason
from greywhale.base.types import Floats

LARGEST = 4 << 20  # bytes
HEAVIEST_KG = 1e4
FURTHEST = 1e6  # m or rad; what lies beyond would only overflow
TURNING = ("revolute", "continuous")
_ELSEWHERE = "choose another description of the arm, or write arm.toml by hand (docs/arm.md)"


@dataclass
class Body:
    """Links that move as one: mass (kg), centre of mass (3,) m, inertia (3, 3) kg m² about it, axes of the base."""

    names: list[str] = field(default_factory=list)
    mass: float = 0.0
    centre: Floats = field(default_factory=lambda: np.zeros(3))
    inertia: Floats = field(default_factory=lambda: np.zeros((3, 3)))

    def add(self, name: str, mass: float, centre: Floats, inertia: Floats) -> None:
        """Weld a link to it."""
        self.names.append(name)
        if mass <= 0.0:
            return
        both = self.mass + mass
        middle = (self.mass * self.centre + mass * centre) / both
        self.inertia = (
            self.inertia + _parallel(self.mass, self.centre - middle) + inertia + _parallel(mass, centre - middle)
        )
        self.mass, self.centre = both, middle


@dataclass(frozen=True)
class TurningJoint:
    """A joint that turns: a point on its axis and the axis (3,), in the base's frame; the body that it moves.

    `low` and `high` are its limits (rad), `effort` (N m), `velocity` (rad/s) and `friction` (N m), NaN where not given.
    """

    name: str
    point: Floats
    axis: Floats
    low: float
    high: float
    effort: float
    velocity: float
    friction: float
    body: Body


def read_chain(path: Path) -> tuple[str, list[TurningJoint]]:
    """The robot's name and its joints from the base outwards. Raises UserError where it is no serial chain."""
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        raise BadUsage(f"{path}: cannot be read: {os_reason(error)}.") from None
    if len(content) > LARGEST or b"<!ENTITY" in content or b"<!DOCTYPE" in content:
        raise BadUsage(f"{path}: it is larger than 4 MiB, or declares entities; a URDF needs neither.")
    try:
        robot = xml.fromstring(content)
    except (xml.ParseError, ValueError, LookupError) as error:
        raise BadUsage(f"{path}: this is no XML: {error}; give a URDF (run xacro first).") from None
    if robot.tag != "robot":
        raise BadUsage(f"{path}: it begins with <{cut(robot.tag)}>, not with <robot>; give a URDF.")
    return robot.get("name", path.stem), _Reader(path, robot).joints()


class _Reader:
    def __init__(self, path: Path, robot: xml.Element) -> None:
        self.path = path
        self.links = {self._name(link, "link"): link for link in robot.findall("link")}
        self.after: dict[str, list[xml.Element]] = {name: [] for name in self.links}
        children = set()
        for joint in robot.findall("joint"):
            ends = [self._end(joint, end) for end in ("parent", "child")]
            self.after[ends[0]].append(joint)
            if ends[1] in children:
                raise self._bad(f"link {cut(ends[1])} has two parents")
            children.add(ends[1])
        roots = [name for name in self.links if name not in children]
        if len(roots) != 1:
            raise self._bad(f"{len(roots)} links have no parent, instead of one base")
        self.root = roots[0]

    def joints(self) -> list[TurningJoint]:
        found: list[TurningJoint] = []
        moving = self._weld(Body(), self.root, np.eye(4))
        while moving:
            if len(moving) > 1:
                names = " and ".join(cut(self._name(joint, "joint")) for joint, _ in moving[:2])
                raise self._bad(f"the chain branches: joints {names} begin at the same body")
            joint, place = moving[0]
            body = Body()
            frame = place @ self._origin(joint)
            found.append(self._turning(joint, frame, body))
            moving = self._weld(body, self._end(joint, "child"), frame)
        return found

    def _weld(self, body: Body, link: str, frame: Floats) -> list[tuple[xml.Element, Floats]]:
        """Add a link and what is fixed to it; the joints that turn from there, with the frame of their parent."""
        moving = []
        welded = [(link, frame)]
        for name, place in welded:
            self._add(body, name, place)
            for joint in self.after[name]:
                if joint.get("type") == "fixed":
                    welded.append((self._end(joint, "child"), place @ self._origin(joint)))
                else:
                    moving.append((joint, place))
        return moving

    def _add(self, body: Body, link: str, frame: Floats) -> None:
        inertial = self.links[link].find("inertial")
        if inertial is None:
            body.add(link, 0.0, np.zeros(3), np.zeros((3, 3)))
        else:
            own = frame @ self._origin(inertial)
            turned = own[:3, :3] @ self._inertia(inertial, link) @ own[:3, :3].T
            mass = self._number(inertial.find("mass"), "value", link)
            if not 0.0 <= mass <= HEAVIEST_KG:
                raise self._bad(f"the mass of link {cut(link)} is {mass:g} kg")
            body.add(link, mass, own[:3, 3], turned)

    def _turning(self, joint: xml.Element, frame: Floats, body: Body) -> TurningJoint:
        name, kind = self._name(joint, "joint"), joint.get("type", "")
        if kind not in TURNING:
            raise self._bad(f"joint {cut(name)} is {cut(kind)}, but every joint must be revolute or continuous")
        axis = self._vector(joint.find("axis"), "xyz", name, (1.0, 0.0, 0.0))
        if not np.linalg.norm(axis) > 1e-9:
            raise self._bad(f"joint {cut(name)} has no axis")
        world = frame[:3, :3] @ axis / np.linalg.norm(axis)
        limit, dynamics = joint.find("limit"), joint.find("dynamics")
        turns_for_ever = kind == "continuous"
        return TurningJoint(
            name=name,
            point=frame[:3, 3],
            axis=world,
            low=-math.tau if turns_for_ever else self._number(limit, "lower", name, 0.0),
            high=math.tau if turns_for_ever else self._number(limit, "upper", name, 0.0),
            effort=self._number(limit, "effort", name, math.nan),
            velocity=self._number(limit, "velocity", name, math.nan),
            friction=self._number(dynamics, "friction", name, math.nan),
            body=body,
        )

    def _inertia(self, inertial: xml.Element, link: str) -> Floats:
        tag = inertial.find("inertia")
        keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        xx, xy, xz, yy, yz, zz = (self._number(tag, key, link, 0.0) for key in keys)
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def _origin(self, owner: xml.Element) -> Floats:
        """(4, 4): an <origin> with roll, pitch and yaw about fixed axes."""
        where = self._name(owner, owner.tag) if owner.tag == "joint" else owner.tag
        tag = owner.find("origin")
        frame = np.eye(4)
        frame[:3, 3] = self._vector(tag, "xyz", where, (0.0, 0.0, 0.0))
        roll, pitch, yaw = self._vector(tag, "rpy", where, (0.0, 0.0, 0.0))
        frame[:3, :3] = _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)
        return frame

    def _vector(self, tag: xml.Element | None, key: str, where: str, otherwise: tuple[float, ...]) -> Floats:
        text = None if tag is None else tag.get(key)
        if text is None:
            return np.array(otherwise)
        try:
            values = np.array([float(part) for part in text.split()])
        except ValueError:
            values = np.empty(0)
        if values.shape != (3,) or not (np.abs(values) <= FURTHEST).all():
            raise self._bad(
                f"{key} of {cut(where)} is {cut(repr(text))}, but it must be three numbers of at most {FURTHEST:g}"
            )
        return values

    def _number(self, tag: xml.Element | None, key: str, where: str, otherwise: float | None = None) -> float:
        text = None if tag is None else tag.get(key)
        if text is None:
            if otherwise is None:
                raise self._bad(f"{key} of {cut(where)} is missing")
            return otherwise
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self._bad(f"{key} of {cut(where)} is {cut(repr(text))}, but it must be a number")
        return value

    def _name(self, tag: xml.Element, kind: str) -> str:
        name = tag.get("name")
        if not name:
            raise self._bad(f"a {kind} has no name")
        return name

    def _end(self, joint: xml.Element, end: str) -> str:
        tag = joint.find(end)
        name = "" if tag is None else tag.get("link", "")
        if name not in self.links:
            raise self._bad(f"the {end} of joint {cut(self._name(joint, 'joint'))} is no link")
        return name

    def _bad(self, what: str) -> UserError:
        return BadUsage(f"{self.path}: {what}; {_ELSEWHERE}.")


def _turn(axis: int, angle: float) -> Floats:
    one, other = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[one, one] = turn[other, other] = math.cos(angle)
    turn[other, one], turn[one, other] = math.sin(angle), -math.sin(angle)
    return turn


def _parallel(mass: float, away: Floats) -> Floats:
    """What a mass adds to an inertia about a point so far from it (Steiner)."""
    return mass * (float(away @ away) * np.eye(3) - np.outer(away, away))
