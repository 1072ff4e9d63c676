"""The positive way that prompts and picture tell is that of the simulated arm, of its equations and of its export."""

from __future__ import annotations

from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest

from greywhale.arm import Arm
from greywhale.arm.export import urdf
from greywhale.board.calibrate.words import POSITIVE_WAYS
from greywhale.files.arm import default_arm
from tools.generate.joint_pictures import PICTURE, VIEWS, draw, turned

TIP = np.array([0.1, 0.0, 0.0])  # in the frame of the hand
SIDE = np.array([0.0, 0.0, 0.1])


def seen(point: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """The place of a point of the exported arm's hand: x ahead of the base, y to its left, z up."""
    joints = list(ElementTree.fromstring(urdf(default_arm())).iter("joint"))
    for joint, angle in reversed(list(zip(joints, angles, strict=True))):
        numbers = {one.tag: one.attrib for one in joint}
        axis, origin = (np.array(numbers[tag]["xyz"].split(), dtype=float) for tag in ("axis", "origin"))
        roll = float(numbers["origin"]["rpy"].split()[0])
        point = origin + turned(turned(point, axis, angle), np.array([1.0, 0.0, 0.0]), roll)
    return point


def along(joint: int, point: np.ndarray) -> list[np.ndarray]:
    """The point's way while one joint turns from 0 in the positive direction."""
    return [seen(point, np.eye(4)[joint] * angle) for angle in np.linspace(0.0, 0.8, 5)]


def test_positive_yaw_is_counter_clockwise_from_above() -> None:
    assert POSITIVE_WAYS[0] == "counter-clockwise, seen from above"
    for one, other in pairwise(along(0, TIP)):
        assert np.cross(one, other)[2] > 0.0


@pytest.mark.parametrize("joint", [1, 2])
def test_positive_pitch_raises_the_hand(joint: int) -> None:
    assert POSITIVE_WAYS[joint].startswith("up: the hand rises")
    for one, other in pairwise(along(joint, TIP)):
        assert other[2] > one[2]


def test_positive_roll_is_clockwise_from_the_elbow() -> None:
    """A person who looks ahead along x sees y on the left and z above: what is on the right goes down."""
    assert POSITIVE_WAYS[3] == "clockwise, seen from the elbow along the hand"
    way = along(3, SIDE)
    assert way[0][1] == pytest.approx(-0.1)
    for one, other in pairwise(way):
        assert other[2] < one[2]


def test_the_simulated_arm_has_the_same_ways() -> None:
    """Level, a positive torque holds it. With the hand upright, yaw and roll turn it the same way round."""
    body = Arm(default_arm()).body
    _, shoulder, wrist, _ = body.bias(np.zeros(4), np.zeros(4))
    assert shoulder > wrist > 0.0
    assert body.mass_matrix(np.array([0.0, 0.0, np.pi / 2, 0.0]))[0, 3] > 0.0


def test_the_picture_turns_about_the_arms_own_axes_and_is_current() -> None:
    """If not: `python -m tools.generate`."""
    axes = [one.attrib["xyz"] for one in ElementTree.fromstring(urdf(default_arm())).iter("axis")]
    assert [np.array(axis.split(), dtype=float).tolist() for axis in axes] == [view.axis.tolist() for view in VIEWS]
    assert PICTURE.read_text(encoding="utf-8") == draw().svg()
