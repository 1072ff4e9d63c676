"""The person at the bench: when the leader moves, and when the follower is held."""

from __future__ import annotations

import numpy as np
import pytest

from greywhale.base.errors import UserError
from greywhale.files.trajectory import Trajectory
from greywhale_sim.leader_player import BRING_BACK_S, LET_GO_S, LeaderPlayer

SLICE = 0.01
START = 1.0
FASTEST_RAD_S = 5.0  # no hand turns a joint faster
FALLEN = np.array([-1.0, -1.0, -1.0, -1.0])


@pytest.fixture
def player(motion: Trajectory) -> LeaderPlayer:
    return LeaderPlayer(motion, SLICE, START)


def advance(player: LeaderPlayer, seconds: float, enabled: bool, follower: np.ndarray = FALLEN) -> None:
    for _ in range(round(seconds / SLICE)):
        player.step(enabled, follower)


def test_holds_until_enabled_plays_once_and_brings_both_arms_back(player: LeaderPlayer, motion: Trajectory) -> None:
    """It lets the follower go at once, and moves after the soft start; after the motors went off it plays again."""
    advance(player, 30.0, enabled=False)
    np.testing.assert_array_equal(player.angles, motion.angles[0])
    np.testing.assert_array_equal(player.hold, motion.angles[0])
    player.step(True, FALLEN)
    assert player.hold is None
    advance(player, START - SLICE, enabled=True)
    np.testing.assert_array_equal(player.angles, motion.angles[0])
    advance(player, 0.5, enabled=True)
    np.testing.assert_allclose(player.angles, motion.angles[0] + 0.5, atol=1e-9)
    assert (player.plays, player.finished) == (0, False)
    advance(player, 60.0, enabled=True)
    assert (player.plays, player.finished) == (1, True)
    np.testing.assert_allclose(player.angles, motion.angles[-1])
    advance(player, LET_GO_S, enabled=False)
    assert player.hold is None, "a fall after a stop must be visible"
    np.testing.assert_allclose(player.angles, motion.angles[-1])
    advance(player, BRING_BACK_S / 2, enabled=False)
    assert player.hold is not None
    np.testing.assert_allclose(player.hold, (FALLEN + motion.angles[0]) / 2)
    np.testing.assert_allclose(player.angles, (motion.angles[-1] + motion.angles[0]) / 2)
    advance(player, BRING_BACK_S / 2 + SLICE, enabled=False)
    np.testing.assert_allclose(player.hold, motion.angles[0])
    advance(player, START + motion.duration_s + 0.05, enabled=True)
    assert player.plays == 2


@pytest.mark.parametrize("off_s", [LET_GO_S + 0.3 * BRING_BACK_S, LET_GO_S / 2])
def test_the_leader_never_jumps_when_the_motors_go_on_before_it_is_back(
    player: LeaderPlayer, motion: Trajectory, off_s: float
) -> None:
    advance(player, START + motion.duration_s + 0.05, enabled=True)
    advance(player, off_s, enabled=False)
    fastest, before = 0.0, player.angles
    for _ in range(round((START + 0.5) / SLICE)):
        advance(player, SLICE, enabled=True)
        fastest = max(fastest, float(np.abs(player.angles - before).max()) / SLICE)
        before = player.angles
    own = float(np.abs(np.diff(motion.at(np.arange(0.0, 0.5, SLICE)), axis=0)).max()) / SLICE
    distance = float(np.abs(motion.angles[-1] - motion.angles[0]).max())
    assert distance > 0.1
    assert fastest <= max(own, distance / START) * 1.01


def test_a_long_motion_is_read_in_pieces() -> None:
    minutes = Trajectory(np.array([0.0, 600.0]), np.array([[0.0] * 4, [1.2] * 4]))
    player = LeaderPlayer(minutes, SLICE, START)
    advance(player, START + 301.0, enabled=True)
    np.testing.assert_allclose(player.angles, 301.0 / 600.0 * 1.2, atol=1e-6)


def test_brings_one_held_arm_elsewhere_while_the_other_stays(player: LeaderPlayer, motion: Trajectory) -> None:
    place = np.array([0.5, -0.5, 0.2, 0.0])
    player.bring(None, place, 2.0)
    advance(player, 1.0, enabled=False)
    assert player.hold is not None
    np.testing.assert_allclose(player.hold, (motion.angles[0] + place) / 2)
    np.testing.assert_array_equal(player.angles, motion.angles[0])
    player.bring(place, None, 1.0)
    advance(player, 10.0, enabled=False)
    np.testing.assert_allclose(player.hold, place)
    np.testing.assert_allclose(player.angles, place)


def test_brings_an_arm_along_places_and_forgets_those_to_come_when_the_motors_go_on(
    player: LeaderPlayer, motion: Trajectory
) -> None:
    places = [(np.full(4, angle), None, seconds) for angle, seconds in ((1.0, 1.0), (-1.0, 2.0), (0.5, 1.0))]
    player.bring_along(places)
    for seconds, angle in ((1.0, 1.0), (2.0, -1.0), (1.0, 0.5), (9.0, 0.5)):
        advance(player, seconds, enabled=False)
        np.testing.assert_allclose(player.angles, angle, atol=0.05)
        np.testing.assert_array_equal(player.hold, motion.angles[0])
    player.bring_along(places)
    advance(player, 0.5, enabled=False)
    advance(player, START, enabled=True)
    advance(player, LET_GO_S + BRING_BACK_S + 5.0, enabled=False)
    np.testing.assert_array_equal(player.angles, motion.angles[0])


def test_no_hand_is_on_an_arm_whose_motors_are_on(player: LeaderPlayer) -> None:
    player.step(True, FALLEN)
    with pytest.raises(UserError, match="only while the motors are off"):
        player.bring(np.ones(4), None, 1.0)


THERE = np.array([0.5, -0.2, 0.0, 1.0])


def test_leads_live_as_quickly_as_a_hand_and_never_jumps_when_the_motors_go_on_or_off(player: LeaderPlayer) -> None:
    player.lead(THERE)
    at = [player.angles]
    for enabled, seconds in ((False, 0.05), (True, 0.1), (False, LET_GO_S + 0.2), (True, 1.5)):
        for _ in range(round(seconds / SLICE)):
            player.step(enabled, FALLEN)
            at.append(player.angles)
        if seconds == 0.05:
            np.testing.assert_array_equal(player.hold, player.angles)
    assert 1.0 < np.abs(np.diff(at, axis=0)).max() / SLICE <= FASTEST_RAD_S + 1e-9
    np.testing.assert_allclose(at[-1], THERE, atol=1e-3)


def test_another_motion_at_work_begins_where_the_leader_is(player: LeaderPlayer, motion: Trajectory) -> None:
    advance(player, START + 0.5, enabled=True)
    for live in (False, True):  # from a motion, and from a live hand
        if live:
            player.lead(THERE)
        advance(player, 0.5, enabled=True)
        player.take_up(motion)
        at = [player.angles]
        for _ in range(round((START + motion.duration_s) / SLICE) + 2):
            player.step(True, FALLEN)
            at.append(player.angles)
        assert np.abs(np.diff(at, axis=0)).max() / SLICE <= FASTEST_RAD_S
        assert any(np.array_equal(angles, motion.angles[0]) for angles in at)
        np.testing.assert_array_equal(player.angles, motion.angles[-1])


def test_a_motion_or_a_place_ends_a_live_hand(player: LeaderPlayer, motion: Trajectory) -> None:
    first = motion.angles[0]
    for how, arguments in (("take_up", [motion]), ("bring", [first, first, 0.5])):
        player.lead(THERE)
        advance(player, 1.0, enabled=False)
        getattr(player, how)(*arguments)
        advance(player, 1.2, enabled=False)
        np.testing.assert_allclose(player.angles, motion.angles[0])
