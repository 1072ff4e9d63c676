"""The motions of a commissioning keep the room and begin at rest; their measures are those of known signals."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.commission.measures import STEPS, measure, traces_of
from greywhale.commission.motions import PARTS, JointRange, check_motion, first_motion
from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.loop.traces import Traces
from greywhale.protocol.firmware import FASTEST_LED_RAD_S, POINT_S, TICK_S
from tools.support.simulated_rig import ROOM


def log_of(leader: np.ndarray, follower: np.ndarray, drop: int = 0) -> Log:
    """A log; every `drop`th row was lost."""
    time = np.arange(len(leader), dtype=np.float64) * TICK_S
    kept = np.ones(len(leader), dtype=bool) if drop == 0 else np.arange(len(leader)) % drop > 0
    kept[0] = True
    state = np.full(int(kept.sum()), "following")
    volts = np.zeros((int(kept.sum()), 4))
    return Log("log", Origin(), time[kept], leader[kept], follower[kept], volts, state, 0, True)


@pytest.mark.parametrize("drop", [0, 50])
def test_the_check_is_found_in_a_log_wherever_it_begins(drop: int) -> None:
    check = check_motion(ROOM)
    times = np.arange(-1.234, check.motion.duration_s, TICK_S)
    leader = check.motion.at(times)
    leader[times < 0.0] += np.linspace(-0.2, 0.0, int((times < 0.0).sum()))[:, None]
    found = traces_of(log_of(leader, leader - 0.01, drop), check)
    assert found.begins == pytest.approx(1.234, abs=0.004)
    measured = measure(found, check, 15.0)
    assert measured.whole
    assert measured.error == pytest.approx(np.full((len(PARTS), 4), 1e-4), rel=1e-3)


def test_a_stopped_check_counts_its_whole_parts_only() -> None:
    check = check_motion(ROOM)
    begin, end = check.parts["moves"]
    leader = check.motion.at(np.arange(0.0, 0.5 * (begin + end), TICK_S))
    measured = measure(traces_of(log_of(leader, leader), check), check, 15.0)
    assert np.isfinite(measured.error[0]).all()
    assert np.isnan(measured.error[1:]).all()
    assert not measured.whole
    assert np.isfinite(measured.worst("unrest")).all()
    assert np.isnan(measured.worst("rattle")).all()


def test_holding_still_is_judged_while_the_joints_own_leader_rests() -> None:
    """A joint that follows its own moves poorly but holds still well has no error there."""
    check = check_motion(ROOM)
    leader = check.motion.at(np.arange(0.0, check.motion.duration_s, TICK_S))
    moving = np.abs(np.gradient(leader, TICK_S, axis=0)) > 0.01
    late = leader - 0.1 * moving
    measured = measure(traces_of(log_of(leader, late), check), check, 15.0)
    place = PARTS.index("holding still")
    # A rest ends a moment after the next move has begun.
    assert (measured.error[place] < 0.03 * measured.error[PARTS.index("reaches")]).all()
    off = leader - 0.01
    assert measure(traces_of(log_of(leader, off), check), check, 15.0).error[place] == pytest.approx(np.full(4, 1e-4))


def test_steps_of_the_moves_have_overshoot_and_settling_time() -> None:
    check = check_motion(ROOM)
    leader = check.motion.at(np.arange(0.0, check.motion.duration_s, TICK_S))
    begin, end = (round(moment / TICK_S) for moment in check.parts[STEPS])
    follower = leader.copy()
    follower[begin:end, 2] += 0.2 * (leader[begin:end, 2] - leader[begin, 2])
    measured = measure(Traces(leader, follower, np.zeros_like(leader), 0.0), check, 15.0)
    place = PARTS.index(STEPS)
    assert measured.overshoot[place, 0] == pytest.approx(0.0, abs=1.0)
    assert measured.settling[place, 0] == pytest.approx(0.0, abs=0.02)
    assert measured.overshoot[place, 2] > 15.0
    assert np.isnan(measured.settling[place, 2]), "it never settles"
    others = [number for number in range(len(PARTS)) if number != place]
    assert np.isnan(measured.overshoot[others]).all()


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
