"""The part of a long log that is kept: whole pieces, all joints, and what is rare."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greywhale.files.log import Log
from greywhale.files.log.layout import Origin
from greywhale.files.log.selection import informative

RATE = 100  # rows a second


def log_of(seconds: int, moves: dict[int, tuple[int, int]], gap_at: int | None = None) -> Log:
    """Joints rest but for the seconds in which they move: joint -> (from, to)."""
    time = np.arange(seconds * RATE) / RATE
    follower = np.random.default_rng(1).normal(0.0, 2e-4, (len(time), 4))
    voltage = np.zeros_like(follower)
    for joint, (start, stop) in moves.items():
        part = (time >= start) & (time < stop)
        follower[part, joint] += 0.5 * np.sin(3.0 * (time[part] - start))
        voltage[part, joint] = 4.0 * np.cos(3.0 * (time[part] - start))
    if gap_at is not None:
        time = time + 1.0 * (time >= gap_at)
    state = np.full(len(time), "following")
    return Log("log", Origin(period_ms=1), time, follower.copy(), follower, voltage, state, 3, True)


def test_a_short_log_stays_as_it_is() -> None:
    log = log_of(60, {0: (0, 60)})
    assert informative(log, 60.0) is log


def test_the_moments_in_which_something_moves_are_found() -> None:
    moves = {0: (100, 110), 1: (330, 335), 2: (50, 60), 3: (480, 490)}
    kept = informative(log_of(600, moves), 40.0)
    assert len(kept.time) == 40 * RATE
    for joint, (start, stop) in moves.items():
        inside = (kept.time >= start) & (kept.time < stop)
        assert inside.sum() >= 4 * RATE, f"joint {joint} moved only then"


def test_a_rare_joint_counts_more_than_another_second_of_a_common_one() -> None:
    kept = informative(log_of(600, {0: (0, 600), 2: (300, 305)}), 20.0)
    assert ((kept.time >= 300) & (kept.time < 305)).sum() == 5 * RATE


def test_pieces_are_whole_and_keep_their_rows_together() -> None:
    log = log_of(300, {0: (0, 300)}, gap_at=203)
    kept = informative(log, 50.0)
    assert (kept.dropped, kept.origin, kept.complete) == (3, log.origin, True)
    places = np.searchsorted(log.time, kept.time)
    for quantity in ("time", "leader", "follower", "voltage", "state"):
        assert np.array_equal(getattr(kept, quantity), getattr(log, quantity)[places])
    starts = np.flatnonzero(np.diff(kept.time, prepend=-1.0) > 1.5 / RATE)
    assert (np.diff([*starts, len(kept.time)]) % (5 * RATE) == 0).all()


def test_rows_without_following_motors_are_left_out() -> None:
    log = log_of(300, {0: (0, 300)})
    state = np.where(log.time < 100.0, "soft_start", "following")
    kept = informative(replace(log, state=state), 50.0)
    assert kept.time.min() >= 100.0
