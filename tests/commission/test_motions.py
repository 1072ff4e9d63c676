"""The motions of a commissioning keep the room, begin and end at rest where the arm is, and small moves come first."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.commission.motions import PARTS, JointRange, check_motion, first_motion
from greywhale.protocol.firmware import FASTEST_LED_RAD_S, POINT_S
from tests.commission.simulated import ROOM

POSE = np.array([0.0, 0.4, -0.3, 0.1])
# At the edge of the room, in its middle, and in a narrow one.
ROOMS = [
    ROOM,
    JointRange(POSE, POSE - np.array([1.0, 0.0, 0.3, 0.02]), POSE + np.array([0.0, 1.0, 0.3, 0.3])),
    JointRange(POSE, POSE - 0.1, POSE + 0.1),
]


@pytest.mark.parametrize("room", ROOMS)
def test_the_check_stays_in_the_room_and_can_be_led(room: JointRange) -> None:
    motion = check_motion(room).motion
    played = motion.at(np.arange(0.0, motion.duration_s, POINT_S))
    assert (played >= room.low - 1e-12).all()
    assert (played <= room.high + 1e-12).all()
    assert np.abs(np.diff(played, axis=0)).max() / POINT_S < FASTEST_LED_RAD_S


@pytest.mark.parametrize("room", ROOMS)
def test_it_begins_and_ends_at_rest_at_the_pose_and_so_does_each_part(room: JointRange) -> None:
    check = check_motion(room)
    assert tuple(check.parts) == PARTS
    ends = [0.0]
    for begin, end in check.parts.values():
        assert begin == pytest.approx(ends[-1])
        ends.append(end)
        moment = np.array([end - 0.3, end])
        assert np.abs(check.motion.at(moment) - room.pose).max() < 1e-9
    assert ends[-1] == pytest.approx(check.motion.duration_s)


def test_small_moves_come_first_and_the_moves_use_the_room() -> None:
    check = check_motion(ROOM)
    far = {}
    for name, (begin, end) in check.parts.items():
        path = check.motion.at(np.arange(begin, end, 0.005)) - ROOM.pose
        far[name] = np.abs(path).max(axis=0)
    assert (far["small moves"] <= 0.1 + 1e-9).all()
    assert far["moves"] == pytest.approx(0.9 * 0.9)
    assert (far["reaches"] > 0.4).all()


def test_the_little_first_motion_goes_where_there_is_room() -> None:
    room = ROOMS[1]
    moved = first_motion(room, 0.15).angles - room.pose
    assert moved[:, 0].min() == pytest.approx(-0.15)
    assert moved[:, 1].max() == pytest.approx(0.15)
    assert moved[0] == pytest.approx(np.zeros(4))
    assert moved[-1] == pytest.approx(np.zeros(4))
