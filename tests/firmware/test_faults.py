"""Sensors that lie and motors that do not obey, on the real images with an arm: off before it has gone far."""

from __future__ import annotations

import pytest

from tools.campaign.faults import CHATTER, campaign

BOARDS = ["mega", "nano"]
RAILS = {"open": "pot_low", "shorted": "pot_high"}


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("side", ["leader", "follower"])
@pytest.mark.parametrize("state", RAILS)
@pytest.mark.parametrize("pattern", [None, *CHATTER])
def test_a_potentiometer_at_a_rail_now_and_then_is_told_before_the_arm_moves(
    board: str, side: str, state: str, pattern: tuple[int, int] | None
) -> None:
    name = f"{side} {state}" + (f" {pattern[0]} of {pattern[1]} ms" if pattern else "")
    found = campaign(board, name, 4, seed=3, settings={})
    assert found.reported == {RAILS[state]: 4}
    assert found.off_ms_max is not None
    assert found.off_ms_max < 14.0
    assert found.grown_rad_max < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS)
def test_a_follower_that_reads_its_neighbour_is_told_when_the_reading_jumps_or_stays(board: str) -> None:
    """At once when the two read different angles. Otherwise once it has stayed under voltage: docs/firmware.md."""
    found = campaign(board, "follower reads neighbour", 8, seed=4, settings={})
    assert set(found.reported) <= {"speed", "stalled", "runaway"}
    assert found.reported["speed"] >= 4
    assert found.off_ms_median is not None
    assert found.off_ms_median < 10.0


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("name", ["motor reversed", "follower pot reversed"])
def test_a_joint_that_runs_the_wrong_way_is_off_after_half_a_rad(board: str, name: str) -> None:
    """When it moves at all: a joint that friction holds at a small error does not."""
    found = campaign(board, name, 8, seed=5, settings={})
    assert set(found.reported) <= {"runaway", "speed", "stalled", "none"}
    assert found.reported["runaway"] >= 4
    assert found.gone_rad_max < 0.5


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS)
def test_a_joint_that_is_blocked_is_told_once_its_motor_pushes(board: str) -> None:
    found = campaign(board, "joint blocked", 8, seed=6, settings={})
    assert set(found.reported) <= {"stalled", "none"}
    assert found.reported["stalled"] >= 4
