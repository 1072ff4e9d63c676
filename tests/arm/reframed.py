"""Writes an arm as another URDF: each link in a frame of its own, axes the other way, another zero pose."""

from __future__ import annotations

from xml.etree import ElementTree as xml

import numpy as np

from greywhale.arm import ArmParameters
from greywhale.arm.export import urdf


def reframed(arm: ArmParameters, seed: int, flips: tuple[int, ...] = (), zero: tuple[float, ...] = (0, 0, 0, 0)) -> str:
    """Every link's frame is turned and moved at random; joints in `flips` turn the other way about their axis; `zero`
    are the angles (rad) of the old joints at the new zero pose.
    """
    random = np.random.default_rng(seed)
    robot = xml.fromstring(urdf(arm))
    frames = {"world": np.eye(4)}  # new frame in the old one
    for link in robot.findall("link"):
        name = str(link.get("name"))
        if name == "world":
            continue
        frames[name] = pose(random.uniform(-0.1, 0.1, 3), rotation(random.normal(size=4)))
        inertial = part(link, "inertial")
        place(inertial, np.linalg.inv(frames[name]) @ origin(inertial))
    for number, joint in enumerate(robot.findall("joint")):
        parent, child = (str(part(joint, tag).get("link")) for tag in ("parent", "child"))
        axis, limit = part(joint, "axis"), part(joint, "limit")
        old = frames[parent], frames[child]
        along = np.array([float(number) for number in str(axis.get("xyz")).split()])
        # A joint's frame is its child's. So the child's new frame must lie on the axis.
        slid = old[1].copy()
        slid[:3, 3] = along * (along @ old[1][:3, 3])
        inertial = part(next(one for one in robot.findall("link") if one.get("name") == child), "inertial")
        place(inertial, np.linalg.inv(slid) @ old[1] @ origin(inertial))
        frames[child] = slid
        turn = pose(np.zeros(3), about(along, zero[number]))
        place(joint, np.linalg.inv(old[0]) @ origin(joint) @ turn @ slid)
        sign = -1.0 if number in flips else 1.0
        axis.set("xyz", text(sign * slid[:3, :3].T @ along))
        ends = sorted(sign * (float(str(limit.get(key))) - zero[number]) for key in ("lower", "upper"))
        limit.set("lower", repr(ends[0]))
        limit.set("upper", repr(ends[1]))
    return xml.tostring(robot, encoding="unicode")


def part(owner: xml.Element, tag: str) -> xml.Element:
    found = owner.find(tag)
    assert found is not None
    return found


def origin(owner: xml.Element) -> np.ndarray:
    tag = part(owner, "origin")
    xyz, (roll, pitch, yaw) = ([float(number) for number in str(tag.get(key)).split()] for key in ("xyz", "rpy"))
    turned = (
        about(np.array([0, 0, 1.0]), yaw) @ about(np.array([0, 1.0, 0]), pitch) @ about(np.array([1.0, 0, 0]), roll)
    )
    return pose(np.array(xyz), turned)


def place(owner: xml.Element, frame: np.ndarray) -> None:
    tag = part(owner, "origin")
    turn = frame[:3, :3]
    pitch = -np.arcsin(np.clip(turn[2, 0], -1.0, 1.0))
    angles = np.array([np.arctan2(turn[2, 1], turn[2, 2]), pitch, np.arctan2(turn[1, 0], turn[0, 0])])
    tag.set("xyz", text(frame[:3, 3]))
    tag.set("rpy", text(angles))


def pose(point: np.ndarray, turn: np.ndarray) -> np.ndarray:
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = turn, point
    return frame


def about(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: np.ndarray = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turned


def rotation(quaternion: np.ndarray) -> np.ndarray:
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return about(np.array([x, y, z]) / np.linalg.norm([x, y, z]), 2.0 * np.arctan2(np.linalg.norm([x, y, z]), w))


def text(values: np.ndarray) -> str:
    return " ".join(repr(float(value)) for value in values)
