"""Reads a URDF as a chain of bodies at its zero pose, everything in the base's frame; fixed joints are welded."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree as xml

import numpy as np

from greywhale.arm.judge_urdf import why_no_body
from greywhale.arm.limits import URDF
from greywhale.arm.urdf_joint import Body, TurningJoint
from greywhale.base.errors import BadUsage, UserError, cut, os_reason
from greywhale.base.types import Floats

TURNING = ("revolute", "continuous")
WIDEST_LIMIT_RAD = 2.0 * math.tau  # to either side; wider limits are in degrees
_XACRO = "xacro}"  # how its elements' names go on after the address of their namespace
_CORRECT = "correct it"
_ELSEWHERE = "choose another description of the arm, or write arm.toml by hand (docs/arm.md)"


def read_chain(path: Path) -> tuple[str, list[TurningJoint]]:
    """The robot's name and its joints from the base outwards. Raises UserError where it is no serial chain."""
    try:
        with path.open("rb") as file:
            content = file.read(URDF.largest_file_bytes + 1)
    except OSError as error:
        raise BadUsage(f"{path}: cannot be read: {os_reason(error)}.") from None
    if len(content) > URDF.largest_file_bytes or b"<!ENTITY" in content or b"<!DOCTYPE" in content:
        raise BadUsage(f"{path}: it is larger than 4 MiB, or declares entities; a URDF needs neither.")
    try:
        robot = xml.fromstring(content)
    except (xml.ParseError, ValueError, LookupError) as error:
        if b"<xacro:" in content:  # its namespace is not declared
            raise _is_xacro(path, "<xacro:...>") from None
        raise BadUsage(f"{path}: this is no XML: {error}; give a URDF (run xacro first).") from None
    if robot.tag == "mujoco":
        raise BadUsage(f"{path}: this is MJCF, the format of MuJoCo; give the URDF that it was made from.")
    if robot.tag != "robot":
        raise BadUsage(f"{path}: it begins with <{cut(robot.tag)}>, not with <robot>; give a URDF.")
    _refuse_xacro(path, robot)
    return robot.get("name", path.stem), _Reader(path, robot).joints()


def _refuse_xacro(path: Path, robot: xml.Element) -> None:
    """Refuse a file that xacro has yet to expand. A declared namespace is no sign of that: xacro leaves it there."""
    for tag in robot.iter():
        name = str(tag.tag)  # a comment's is a function
        if _XACRO in name:
            raise _is_xacro(path, f"<xacro:{cut(name.partition('}')[2])}>")
        for key, text in tag.attrib.items():
            if "${" in text or "$(" in text:
                raise _is_xacro(path, f"{cut(repr(text))} as {cut(key)} of <{cut(name)}>")


def _is_xacro(path: Path, sign: str) -> UserError:
    return BadUsage(
        f"{path}: this is xacro, from which a URDF is made: it has {sign}; run `xacro {path} -o arm.urdf`, and import "
        "arm.urdf."
    )


class _Reader:
    def __init__(self, path: Path, robot: xml.Element) -> None:
        self.path = path
        self.links = {self._name(link, "link"): link for link in robot.findall("link")}
        self._refuse_twins(robot)
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

    def _refuse_twins(self, robot: xml.Element) -> None:
        for kind in ("link", "joint"):
            names = Counter(self._name(tag, kind) for tag in robot.findall(kind))
            for name, count in names.items():
                if count > 1:
                    raise self._bad(f"{count} {kind}s are called {cut(name)}", "give each a name of its own")

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
            inertia = self._inertia(inertial, link)
            if reason := why_no_body(inertia):
                raise self._bad(f"link {cut(link)} is no possible body: {reason}", _CORRECT)
            turned = own[:3, :3] @ inertia @ own[:3, :3].T
            mass = self._number(inertial.find("mass"), "value", link)
            if not 0.0 <= mass <= URDF.heaviest_kg:
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
        if joint.find("mimic") is not None:
            raise self._bad(f"joint {cut(name)} follows another one (<mimic>), and has no motor of its own")
        limit, dynamics = joint.find("limit"), joint.find("dynamics")
        turns_for_ever = kind == "continuous"
        low, high = (-math.tau, math.tau) if turns_for_ever else self._limits(limit, name)
        return TurningJoint(
            name=name,
            point=frame[:3, 3],
            axis=world,
            low=low,
            high=high,
            effort=self._effort(limit, "effort", name, turns_for_ever),
            velocity=self._effort(limit, "velocity", name, turns_for_ever),
            friction=self._not_below_0(dynamics, "friction", name),
            damping=self._not_below_0(dynamics, "damping", name),
            body=body,
            endless=turns_for_ever,
        )

    def _limits(self, limit: xml.Element | None, name: str) -> tuple[float, float]:
        """The lower and the upper one (rad). They are never exchanged: the axis may be what is wrong."""
        low, high = self._number(limit, "lower", name, 0.0), self._number(limit, "upper", name, 0.0)
        limits = f"joint {cut(name)} has its lower limit at {low:g} rad and its upper one at {high:g} rad"
        if low > high:
            raise self._bad(limits, "exchange the two if that is meant, and look whether its axis points the right way")
        if low == high:
            raise self._bad(f"{limits}, so it cannot turn", "give its limits, or make it fixed")
        if max(-low, high) > WIDEST_LIMIT_RAD:
            raise self._bad(f"{limits}; limits are in rad, and these look like degrees", _CORRECT)
        return low, high

    def _effort(self, limit: xml.Element | None, key: str, name: str, optional: bool) -> float:
        """Effort or velocity; 0 where it is not known, as those write it who do not know it."""
        value = self._not_below_0(limit, key, name)
        if math.isnan(value) and not optional:
            raise self._bad(
                f"joint {cut(name)} has no effort or velocity limit, from which its motor would follow",
                'add them: <limit effort="N m" velocity="rad/s" .../>, or 0 for a guess',
            )
        return 0.0 if math.isnan(value) else value

    def _not_below_0(self, tag: xml.Element | None, key: str, name: str) -> float:
        """NaN where it is not given."""
        value = self._number(tag, key, name, math.nan)
        if value < 0.0:
            raise self._bad(f"{key} of joint {cut(name)} is {value:g}, but it must not be below 0", _CORRECT)
        return value

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
        if max(abs(roll), abs(pitch), abs(yaw)) > WIDEST_LIMIT_RAD:
            angles = f"rpy of {cut(where)} is {roll:g} {pitch:g} {yaw:g}"
            raise self._bad(f"{angles}; angles are in rad, and these look like degrees", _CORRECT)
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
        if values.shape != (3,) or not (np.abs(values) <= URDF.largest_number).all():
            raise self._bad(
                f"{key} of {cut(where)} is {cut(repr(text))}, but it must be three numbers of at most "
                f"{URDF.largest_number:g}"
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

    def _bad(self, what: str, remedy: str = _ELSEWHERE) -> UserError:
        return BadUsage(f"{self.path}: {what}; {remedy}.")


def _turn(axis: int, angle: float) -> Floats:
    one, other = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[one, one] = turn[other, other] = math.cos(angle)
    turn[other, one], turn[one, other] = math.sin(angle), -math.sin(angle)
    return turn
